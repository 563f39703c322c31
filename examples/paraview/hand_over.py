"""Hands meshes to other programs, a file a label.

    pvpython hand_over.py PLUGIN SEGMENTATION FOLDER [FACTOR]

Writes FOLDER/label-N.ply for MeshLab, Blender and surface_morphometrics, FOLDER/label-N.vtp for
pycurv and FOLDER/label-N.vtu, an unstructured grid, for TS2CG. All lengths are multiplied by FACTOR
first: 0.1 makes nanometres of ångströms.
"""

import os
import sys

from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

plugin, segmentation_file, folder = sys.argv[1:4]
factor = float(sys.argv[4]) if len(sys.argv) > 4 else 1.0
os.makedirs(folder, exist_ok=True)
LoadPlugin(plugin, remote=False, ns=globals())

segmentation = OpenDataFile(segmentation_file)
segmentation.UpdatePipeline()
mesh = MidSurface(Input=segmentation)

# Points and Thickness are lengths both. Unit normals stay as they are.
scaled = Transform(Input=mesh, TransformAllInputVectors=0)
scaled.Transform.Scale = [factor] * 3
converted = Calculator(Input=scaled, ResultArrayName="Thickness", Function=f"Thickness * {factor}")
converted.UpdatePipeline()

labels = set(vtk_to_numpy(servermanager.Fetch(converted).GetCellData().GetArray("Label")))
for label in sorted(labels):
    one = Threshold(Input=converted, Scalars=["CELLS", "Label"])
    one.LowerThreshold = one.UpperThreshold = label
    surface = ExtractSurface(Input=one)
    name = os.path.join(folder, f"label-{label}")

    SaveData(name + ".ply", proxy=surface, EnableColoring=0, EnableAlpha=0)
    SaveData(name + ".vtp", proxy=surface, DataMode="Binary")
    SaveData(name + ".vtu", proxy=one, DataMode="Binary")

    sizes = CellSize(Input=surface, ComputeVertexCount=0, ComputeLength=0, ComputeVolume=0)
    sizes.UpdatePipeline()
    area = vtk_to_numpy(servermanager.Fetch(sizes).GetCellData().GetArray("Area"))
    print(f"label {label}: {len(area)} triangles of {area.mean():.3g} on average")
