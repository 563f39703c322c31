"""Curvature of a membrane, and its distance to another one, with ParaView's own filters.

    pvpython curvature_and_distance.py PLUGIN SEGMENTATION FOLDER [FROM TO]

FROM and TO are labels: 2 and 1 (the inner and the outer membrane of the sample) if not given.
Writes FOLDER/measured.vtp: the mid-surface of FROM with the point arrays Mean_Curvature, one over
length, and Distance, to the nearest point of the mid-surface of TO.
"""

import os
import sys

from paraview.simple import *

plugin, segmentation_file, folder = sys.argv[1:4]
label, other_label = sys.argv[4:6] if len(sys.argv) > 4 else ("2", "1")
os.makedirs(folder, exist_ok=True)
LoadPlugin(plugin, remote=False, ns=globals())

segmentation = OpenDataFile(segmentation_file)
segmentation.UpdatePipeline()
membrane = MidSurface(Input=segmentation, Labels=[label])
other = MidSurface(Input=segmentation, Labels=[other_label])

# Voxels leave ripples that curvature shows first: smooth a copy before.
smooth = Smooth(Input=membrane, NumberofIterations=20)
curved = Curvature(Input=smooth, CurvatureType="Mean")

# The window's Programmable Filter takes the same two inputs, selected together, and this script.
measured = ProgrammableFilter(Input=[curved, other], OutputDataSetType="Same as Input", Script="""
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

output.ShallowCopy(inputs[0].VTKObject)
surface = vtkImplicitPolyDataDistance()
surface.SetInput(inputs[1].VTKObject)
distance = vtkDoubleArray()
distance.SetName("Distance")
surface.FunctionValue(inputs[0].VTKObject.GetPoints().GetData(), distance)
for index in range(distance.GetNumberOfTuples()):  # its sign only tells the side
    distance.SetValue(index, abs(distance.GetValue(index)))
output.GetPointData().AddArray(distance)
""")
measured.UpdatePipeline()
for name in ("Mean_Curvature", "Distance"):
    low, high = measured.PointData[name].GetRange()
    print(f"{name}: {low:.3g} to {high:.3g}")
SaveData(os.path.join(folder, "measured.vtp"), proxy=measured, DataMode="Binary")
