"""Places lipids on both sides of the mid-surface, half a thickness away from it.

    pvpython lipids.py PLUGIN SEGMENTATION FOLDER

Writes FOLDER/heads.csv, two heads a point of the mesh with positions and directions, for other
programs, and FOLDER/lipids.vtp, an arrow from every tenth head towards the middle of the membrane.
"""

import os
import sys

from paraview.simple import *

plugin, segmentation_file, folder = sys.argv[1:]
os.makedirs(folder, exist_ok=True)
LoadPlugin(plugin, remote=False, ns=globals())

segmentation = OpenDataFile(segmentation_file)
segmentation.UpdatePipeline()
mesh = MidSurface(Input=segmentation)

leaflets = []
for side in (1, -1):
    # The points moved along the normals; the arrow points back to the mid-surface.
    heads = Calculator(Input=mesh, CoordinateResults=1, ResultArrayName="Moved")
    heads.Function = f"coords + {0.5 * side} * Thickness * Normals"
    inwards = Calculator(Input=heads, ResultArrayName="Direction", Function=f"{-side} * Normals")
    leaflets.append(inwards)
both = AppendGeometry(Input=leaflets)

lipids = Glyph(Input=both, GlyphType="Arrow", GlyphMode="Every Nth Point", Stride=10)
lipids.OrientationArray = ["POINTS", "Direction"]
lipids.ScaleArray = ["POINTS", "Thickness"]  # a thick membrane has long lipids
lipids.ScaleFactor = 0.4

SaveData(os.path.join(folder, "lipids.vtp"), proxy=lipids, DataMode="Binary")
SaveData(os.path.join(folder, "heads.csv"), proxy=both, ChooseArraysToWrite=1,
         PointDataArrays=["Direction", "Thickness"])
lipids.UpdatePipeline()
print(both.GetDataInformation().GetNumberOfPoints(), "lipids")
