"""Fails unless a picture of ParaView's window shows a closed surface coloured by its thickness.

Of a vesicle, seen along z: without its caps one would look through it. Loose on purpose: fonts, lights and window sizes differ. The view is the largest part of the window
in ParaView's bluish grey; the colour legend stands in its lower right corner.
"""

import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

reader = vtkPNGReader()
reader.SetFileName(sys.argv[1])
reader.Update()
image = reader.GetOutput()
width, height, _ = image.GetDimensions()
pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3]
pixels = pixels.astype(int)

BACKGROUND = (82, 87, 110)
far = abs(pixels - BACKGROUND).max(axis=2) > 12
# The rows and columns that the view fills; icons have a few pixels of its colour, too.
rows = ((~far).mean(axis=1) > 0.3).nonzero()[0]
columns = ((~far).mean(axis=0) > 0.3).nonzero()[0]
assert len(rows) > 0 and len(columns) > 0, "the view's background is not to be seen"
top, bottom = rows.min(), rows.max()
left, right = columns.min(), columns.max()
# Without the arrows in the lower left corner and the legend.
part = (slice(top + 10, top + (bottom - top) * 3 // 4), slice(left + 10, left + (right - left) * 3 // 4))


def share(mask):
    return mask.mean()


surface = far[part]
assert 0.005 < share(surface) < 0.8, f"{share(surface):.1%} of the view is surface"
middle = (slice(top + (bottom - top) * 9 // 20, top + (bottom - top) * 11 // 20),
          slice(left + (right - left) * 9 // 20, left + (right - left) * 11 // 20))
assert share(far[middle]) > 0.95, "the surface is open in the middle, where its caps are"

# The legend runs from ParaView's blue over near white to its red.
legend = pixels[(top + bottom) // 2 : bottom, (left + right) // 2 : right]
red, blue = legend[:, :, 0], legend[:, :, 2]
assert (red - blue > 80).sum() > 50, "no red end of the legend"
assert (blue - red > 80).sum() > 50, "no blue end of the legend"

# Several hues on the surface: not one solid colour under a light.
drawn = pixels[part][surface]
warmth = drawn[:, 0] - drawn[:, 2]
spread = sorted(warmth)[len(warmth) * 19 // 20] - sorted(warmth)[len(warmth) // 20]
assert spread > 30, f"one colour all over: its warmth differs by {spread}"
print(f"{share(surface):.1%} of the view is surface, its warmth differs by {spread}")
