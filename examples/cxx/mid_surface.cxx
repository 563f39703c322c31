// The filter in a VTK pipeline: mid_surface SEGMENTATION.vti MESH.vtp
#include <vtkMidSurfaceFilter.h>
#include <vtkNew.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataWriter.h>

int main(int argc, char** argv)
{
  if (argc != 3)
  {
    return 2;
  }
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(argv[1]);
  vtkNew<vtkMidSurfaceFilter> midSurface;
  midSurface->SetInputConnection(reader->GetOutputPort());
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputConnection(midSurface->GetOutputPort());
  writer->SetFileName(argv[2]);
  writer->SetDataModeToBinary(); // Debian 12 cannot read back the default, appended data
  return writer->Write() ? 0 : 1;
}
