"""The filter in a VTK pipeline in plain Python: python3 mid_surface.py SEGMENTATION.vti MESH.vtp"""

import sys

from midsurface import vtkMidSurfaceFilter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataWriter

segmentation_file, mesh_file = sys.argv[1:]
reader = vtkXMLImageDataReader()
reader.SetFileName(segmentation_file)

mid_surface = vtkMidSurfaceFilter()
mid_surface.SetInputConnection(reader.GetOutputPort())
mid_surface.Update()
mesh = mid_surface.GetOutput()
print(mesh.GetNumberOfPoints(), "points,", mesh.GetNumberOfPolys(), "triangles")
low, high = mesh.GetPointData().GetArray("Thickness").GetRange()
print(f"thickness from {low:.2f} to {high:.2f}")

writer = vtkXMLPolyDataWriter()
writer.SetInputConnection(mid_surface.GetOutputPort())
writer.SetFileName(mesh_file)
writer.SetDataModeToBinary()  # Debian 12 cannot read back the default, appended data
sys.exit(0 if writer.Write() else 1)
