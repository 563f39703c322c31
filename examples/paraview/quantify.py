"""From a segmentation to a quantified mesh: the mesh as .vtp, its figures as a table.

    pvpython quantify.py PLUGIN SEGMENTATION FOLDER

Writes FOLDER/mid-surface.vtp and FOLDER/pieces.csv: a line for all, one for each label and one for
each piece of membrane (component), in the units of the segmentation.
"""

import os
import sys

from paraview import servermanager
from paraview.simple import *

plugin, segmentation_file, folder = sys.argv[1:]
os.makedirs(folder, exist_ok=True)
LoadPlugin(plugin, remote=False, ns=globals())

# 1. Open the file, and see whether its voxel size is what it should be.
segmentation = OpenDataFile(segmentation_file)
segmentation.UpdatePipeline()
print("voxel size:", servermanager.Fetch(segmentation).GetSpacing())

# 2. The mid-surface of all labels. For some of them: mesh.Labels = ["1", "3"]
mesh = MidSurface(Input=segmentation)

# 3. Its figures: area, thickness, closed or open, quality of the triangles.
statistics = MidSurfaceStatistics(Input=mesh)
SaveData(os.path.join(folder, "pieces.csv"), proxy=statistics)
table = servermanager.Fetch(statistics)
for row in range(table.GetNumberOfRows()):
    piece, area, thickness = (
        table.GetValueByName(row, name).ToString() for name in ("Of", "Area", "ThicknessMedian")
    )
    print(f"{piece}: area {area}, thickness {thickness}")

# 4. Save the mesh. DataMode matters: Debian 12's ParaView cannot read back its own default.
SaveData(os.path.join(folder, "mid-surface.vtp"), proxy=mesh, DataMode="Binary")
