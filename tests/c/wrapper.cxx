// Tests of midsurface.hpp: ownership, exceptions, and what the C interface cannot have by itself.
#include "volumes.h"

#include <midsurface.hpp>

#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace
{
using midsurface::Options;

int failedChecks = 0;

#define CHECK(condition) Check((condition), #condition, __LINE__)

void Check(bool condition, const char* text, int line)
{
  if (!condition)
  {
    std::printf("%s:%d: not true: %s\n", __FILE__, line, text);
    failedChecks++;
  }
}

struct Sheets
{
  std::uint8_t Scalars[VOXELS];
  midsurface_volume Volume = two_sheets(this->Scalars);
};

void LabelsAreFound()
{
  Sheets sheets;
  CHECK((midsurface::FindLabels(sheets.Volume) == std::vector<std::int64_t>{ 1, 3 }));
  std::memset(sheets.Scalars, 0, sizeof sheets.Scalars);
  CHECK(midsurface::FindLabels(sheets.Volume).empty());
}

bool SameMesh(const midsurface_mesh_arrays& a, const midsurface_mesh_arrays& b)
{
  return a.point_count == b.point_count && a.triangle_count == b.triangle_count &&
    std::memcmp(a.points, b.points, 3 * a.point_count * sizeof *a.points) == 0 &&
    std::memcmp(a.triangles, b.triangles, 3 * a.triangle_count * sizeof *a.triangles) == 0;
}

void LinesAreCopiedAndZipped()
{
  Sheets sheets;
  const midsurface::Polylines lines = midsurface::ExtractPolylines(sheets.Volume);
  const midsurface::Polylines copy = midsurface::MakePolylines(midsurface::Arrays(lines));
  const midsurface::Mesh mesh = midsurface::Zip(lines);
  const midsurface::Mesh zipped = midsurface::Zip(copy);
  CHECK(midsurface::Arrays(mesh).triangle_count > 0);
  CHECK(SameMesh(midsurface::Arrays(mesh), midsurface::Arrays(zipped)));
}

void LabelsAreChosen()
{
  Sheets sheets;
  Options options;
  options.Labels = { 3 };
  const midsurface::Mesh one = midsurface::Extract(sheets.Volume, options);
  const midsurface_mesh_arrays arrays = midsurface::Arrays(one);
  CHECK(arrays.triangle_count > 0);
  for (std::size_t t = 0; t < arrays.triangle_count; t++)
  {
    CHECK(arrays.labels[t] == 3);
  }
  // An empty choice is no choice at all, not all labels.
  int warnings = 0;
  options.Labels.emplace();
  options.Warning = [&](const char*) { warnings++; };
  const midsurface::Mesh none = midsurface::Extract(sheets.Volume, options);
  CHECK(midsurface::Arrays(none).triangle_count == 0);
  CHECK(warnings > 0);
}

void TheRidgeFieldIsWritten()
{
  Sheets sheets;
  std::vector<float> distance(VOXELS, -1.0F), ridge(VOXELS, -1.0F);
  midsurface::RidgeField(sheets.Volume, distance.data(), ridge.data(), VOXELS);
  CHECK(distance[5] > 0.0F && distance[0] == 0.0F);
  CHECK(ridge[5] > 0.0F);
}

// The status of the error that the callable must throw.
template <typename Callable>
midsurface_status StatusOf(Callable callable, const char* text)
{
  try
  {
    callable();
  }
  catch (const midsurface::Error& error)
  {
    CHECK(std::strstr(error.what(), text) != nullptr);
    return error.Status;
  }
  return MIDSURFACE_STATUS_OK;
}

void FailuresAreThrown()
{
  Sheets sheets;
  sheets.Volume.spacing[1] = 0.0;
  const auto extract = [&] { midsurface::Extract(sheets.Volume); };
  CHECK(StatusOf(extract, "spacing") == MIDSURFACE_STATUS_INVALID_ARGUMENT);
  const auto view = [] { midsurface::Arrays(midsurface::Mesh()); };
  CHECK(StatusOf(view, "`mesh` is NULL") == MIDSURFACE_STATUS_INVALID_ARGUMENT);
  const auto make = [] {
    midsurface_polyline_arrays arrays{};
    arrays.point_count = 1;
    midsurface::MakePolylines(arrays);
  };
  CHECK(StatusOf(make, "`arrays.points` is NULL") == MIDSURFACE_STATUS_INVALID_ARGUMENT);
}

void CancellingIsThrown()
{
  Sheets sheets;
  Options options;
  options.Progress = [](double, const char*) { return false; };
  const auto extract = [&] { midsurface::Extract(sheets.Volume, options); };
  CHECK(StatusOf(extract, "cancelled") == MIDSURFACE_STATUS_CANCELLED);
}

// What a callback throws reaches the caller, without unwinding through the library.
void CallbacksMayThrow()
{
  Sheets sheets;
  std::string caught;
  const auto extract = [&](const Options& options) {
    caught.clear();
    try
    {
      midsurface::Extract(sheets.Volume, options);
    }
    catch (const std::logic_error& error)
    {
      caught = error.what();
    }
  };
  Options options;
  options.Progress = [](double, const char*) -> bool { throw std::logic_error("from progress"); };
  extract(options);
  CHECK(caught == "from progress");

  Options warned;
  warned.Labels.emplace();
  warned.Warning = [](const char*) { throw std::logic_error("from warning"); };
  extract(warned);
  CHECK(caught == "from warning");
}

void HandlesAreMovedNotCopied()
{
  static_assert(!std::is_copy_constructible_v<midsurface::Mesh>);
  static_assert(sizeof(midsurface::Mesh) == sizeof(void*));
  Sheets sheets;
  midsurface::Mesh mesh = midsurface::Extract(sheets.Volume);
  const midsurface::Mesh moved = std::move(mesh);
  CHECK(mesh == nullptr && moved != nullptr);
}
} // namespace

int main()
{
  void (*const tests[])() = { LabelsAreFound, LinesAreCopiedAndZipped, LabelsAreChosen,
    TheRidgeFieldIsWritten, FailuresAreThrown, CancellingIsThrown, CallbacksMayThrow,
    HandlesAreMovedNotCopied };
  int passed = 0, failed = 0;
  for (const auto test : tests)
  {
    failedChecks = 0;
    test();
    (failedChecks == 0 ? passed : failed)++;
  }
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 ? 0 : 1;
}
