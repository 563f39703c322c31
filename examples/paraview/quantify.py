"""From a segmentation to a quantified mesh: the mesh as .vtp, its figures as a table.

    pvpython quantify.py PLUGIN SEGMENTATION FOLDER

Writes FOLDER/mid-surface.vtp and FOLDER/pieces.csv, a line for each piece of membrane: label,
component, area and mean thickness, in the units of the segmentation.
"""

import csv
import os
import sys

from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

plugin, segmentation_file, folder = sys.argv[1:]
LoadPlugin(plugin, remote=False, ns=globals())

# 1. Open the file, and see whether its voxel size is what it should be.
segmentation = OpenDataFile(segmentation_file)
segmentation.UpdatePipeline()
print("voxel size:", servermanager.Fetch(segmentation).GetSpacing())

# 2. The mid-surface of all labels. For some of them: mesh.Labels = ["1", "3"]
mesh = MidSurface(Input=segmentation)

# 3. Thickness from the points to the triangles, then area and mean thickness of each piece.
on_triangles = PointDatatoCellData(Input=mesh)
sized = CellSize(Input=on_triangles, ComputeVertexCount=0, ComputeLength=0, ComputeVolume=0)
sized.UpdatePipeline()
cells = servermanager.Fetch(sized).GetCellData()
label, component, thickness, area = (
    vtk_to_numpy(cells.GetArray(name)) for name in ("Label", "Component", "Thickness", "Area")
)
with open(os.path.join(folder, "pieces.csv"), "w", newline="") as file:
    table = csv.writer(file)
    table.writerow(["label", "component", "area", "mean thickness"])
    for piece in sorted(set(zip(label, component))):
        chosen = (label == piece[0]) & (component == piece[1])
        total = area[chosen].sum()
        mean = (thickness[chosen] * area[chosen]).sum() / total
        table.writerow([*piece, f"{total:.6g}", f"{mean:.4g}"])
        print(f"label {piece[0]}, component {piece[1]}: area {total:.6g}, thickness {mean:.4g}")

# 4. Save the mesh. DataMode matters: Debian 12's ParaView cannot read back its own default.
SaveData(os.path.join(folder, "mid-surface.vtp"), proxy=mesh, DataMode="Binary")
