// The real vtkMidSurfaceFilter for programs that know nothing of VTK: the tests in Rust.
#ifndef FilterBridge_h
#define FilterBridge_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/** One filter with its input image. */
class __attribute__((visibility("default"))) FilterBridge
{
public:
  FilterBridge();
  ~FilterBridge();

  /** The image's points: first and last index along each axis; the direction is row-major. */
  void SetFrame(const std::array<int32_t, 6>& extent, const std::array<double, 3>& spacing,
    const std::array<double, 3>& origin, const std::array<double, 9>& direction) const;

  /** Adds an array of a VTK type, such as VTK_SHORT, and has it segmented. Copies the bytes. */
  void AddArray(
    int32_t type, int32_t components, const uint8_t* bytes, size_t size, bool onCells) const;

  void SetMethod(int32_t method) const;
  void SetEdgeLength(double length) const;
  void SetThreads(int32_t threads) const;
  void SetThreshold(double threshold) const;
  void ChooseLabel(int64_t label) const;

  /** Runs the filter; true without an error message. May be called again. */
  bool Update() const;

  /** The last run's errors and warnings. */
  const std::string& GetErrors() const;
  const std::string& GetWarnings() const;

  /** Arrays of the mesh; empty where it has none. */
  std::unique_ptr<std::vector<float>> GetPoints() const;
  std::unique_ptr<std::vector<int64_t>> GetTriangles() const;
  std::unique_ptr<std::vector<float>> GetPointArray(const std::string& name) const;
  std::unique_ptr<std::vector<int64_t>> GetCellArray(const std::string& name) const;

private:
  struct Internals;
  std::unique_ptr<Internals> Data;
};

__attribute__((visibility("default"))) std::unique_ptr<FilterBridge> MakeFilterBridge();

#endif
