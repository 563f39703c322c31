// Two filters in two threads at once give what each gives by itself.
#include "vtkImageData.h"
#include "vtkMidSurfaceFilter.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <cmath>
#include <cstring>
#include <iostream>
#include <thread>

namespace
{
constexpr int runs = 50;

/** A sphere of a radius of its own, label 1. */
void FillSphere(vtkImageData* image, double radius)
{
  constexpr int size = 40;
  image->SetDimensions(size, size, size);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* values = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int index = 0; index < size * size * size; ++index)
  {
    const double x = index % size - 19.3;
    const double y = index / size % size - 19.1;
    const double z = index / size / size - 19.6;
    values[index] = std::abs(std::sqrt(x * x + y * y + z * z) - radius) < 2.0;
  }
}

bool AreSame(vtkPolyData* first, vtkPolyData* second)
{
  const vtkIdType count = first->GetNumberOfPoints();
  return count > 0 && count == second->GetNumberOfPoints() &&
    first->GetNumberOfPolys() == second->GetNumberOfPolys() &&
    std::memcmp(first->GetPoints()->GetVoidPointer(0), second->GetPoints()->GetVoidPointer(0),
      3 * sizeof(float) * static_cast<size_t>(count)) == 0;
}

/** Whether each of many runs gives the same mesh as the first. */
void RunAgainAndAgain(vtkMidSurfaceFilter* filter, vtkPolyData* expected, bool* isSame)
{
  for (int run = 0; *isSame && run < runs; ++run)
  {
    filter->Modified();
    filter->Update();
    *isSame = AreSame(filter->GetOutput(), expected);
  }
}
} // namespace

int main()
{
  bool isSame[2] = { true, true };
  vtkNew<vtkImageData> images[2];
  vtkNew<vtkMidSurfaceFilter> filters[2];
  vtkNew<vtkPolyData> expected[2];
  for (int which = 0; which < 2; ++which)
  {
    FillSphere(images[which], 11.0 + which);
    filters[which]->SetInputData(images[which]);
    filters[which]->SetMethod(
      which ? vtkMidSurfaceFilter::POLYLINE_ZIPPER : vtkMidSurfaceFilter::RIDGE_SURFACE);
    filters[which]->Update();
    expected[which]->DeepCopy(filters[which]->GetOutput());
  }
  std::thread other(RunAgainAndAgain, filters[0].Get(), expected[0].Get(), &isSame[0]);
  RunAgainAndAgain(filters[1], expected[1], &isSame[1]);
  other.join();
  for (int which = 0; which < 2; ++which)
  {
    if (!isSame[which])
    {
      std::cerr << "failed: filter " << which << " gave another mesh\n";
    }
  }
  return isSame[0] && isSame[1] ? 0 : 1;
}
