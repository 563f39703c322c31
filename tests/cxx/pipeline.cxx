// The filter in a VTK pipeline: the mid-surface of a sheet.
#include "vtkImageData.h"
#include "vtkMidSurfaceFilter.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <iostream>

int main()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(20, 12, 10);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  for (int z = 0; z < 10; ++z)
  {
    auto* slice = static_cast<unsigned char*>(image->GetScalarPointer(0, 0, z));
    std::fill_n(slice, 20 * 12, static_cast<unsigned char>(0));
    std::fill_n(slice + 20 * 4, 20 * 4, static_cast<unsigned char>(1));
  }
  vtkNew<vtkMidSurfaceFilter> filter;
  filter->SetInputData(image);
  filter->Update();
  vtkPolyData* mesh = filter->GetOutput();
  std::cout << mesh->GetNumberOfPoints() << " points, " << mesh->GetNumberOfPolys()
            << " triangles\n";
  return mesh->GetNumberOfPolys() > 100 ? 0 : 1;
}
