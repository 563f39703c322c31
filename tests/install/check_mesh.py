"""Fails unless the .vtp file named holds a mid-surface: triangles, and all arrays at full length."""

import sys

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

reader = vtkXMLPolyDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
mesh = reader.GetOutput()
assert mesh.GetNumberOfPolys() > 1000, f"{mesh.GetNumberOfPolys()} triangles"
for fields, names, count in (
    (mesh.GetPointData(), ("Normals", "Thickness"), mesh.GetNumberOfPoints()),
    (mesh.GetCellData(), ("Label", "Component"), mesh.GetNumberOfCells()),
):
    for name in names:
        array = fields.GetArray(name)
        assert array is not None and array.GetNumberOfTuples() == count, name
