"""Several processes that share one component, which is worked on in tiles: all of them together give
what one gives.

`mpiexec -n 1 pvbatch tiles.py PLUGIN VOLUME` writes a volume, and beside it what one process makes of
it; with more processes the same command compares.
"""
import sys

import numpy as np
from paraview import simple

from pipeline import arrays, image
from ranks import columns, fetch
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
from vtkmodules.vtkParallelCore import vtkMultiProcessController

# More labelled voxels than are worked on at once, in a volume three tiles long.
SHAPE = (48, 230, 1290)
THICKNESS = 15.0
# Where two of the tiles meet.
HOLE, RADIUS = (512, 110), 25.0


def write_volume(path):
    """A wavy sheet from border to border with rough faces and a hole, and a small sheet below it."""
    z, y, x = np.ogrid[tuple(slice(n) for n in SHAPE)]
    height = 26.0 + 5.0 * np.sin(x / 60) * np.cos(y / 50)
    rough = np.random.default_rng(1).random(SHAPE, np.float32) - 0.5
    volume = abs(z - height + 0.8 * rough) < 0.5 * THICKNESS
    volume &= np.hypot(x - HOLE[0], y - HOLE[1]) > RADIUS
    assert np.count_nonzero(volume) > 4_100_000
    volume[2:6, 20:60, 480:540] = True
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(image(volume.astype(np.uint8)))
    writer.SetDataModeToBinary()
    writer.SetCompressorTypeToNone()
    writer.Write()


def merged(mesh, ids):
    """Points with all that belongs to them, each once, and triangles of their numbers, both in an order
    of their own. Points of which several processes have one are the same in all."""
    points = np.column_stack([mesh["points"], mesh["point Normals"], mesh["point Thickness"]])
    _, first, number = np.unique(ids, return_index=True, return_inverse=True)
    np.testing.assert_array_equal(points, points[first][number])
    order = np.lexsort(points[first].T[2::-1])
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    triangles = rank[number][mesh["polys"]].reshape(-1, 3)
    least = np.argmin(triangles, axis=1)[:, None]
    triangles = np.take_along_axis(triangles, (least + np.arange(3)) % 3, axis=1)
    rows = np.column_stack([triangles, mesh["cell Component"]])
    return {"points": points[first][order], "triangles": rows[np.lexsort(rows.T[::-1])]}


def main():
    plugin, path = sys.argv[1:]
    processes = vtkMultiProcessController.GetGlobalController().GetNumberOfProcesses()
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    if processes == 1:
        write_volume(path)
    ridge = simple.MidSurface(Input=simple.XMLImageDataReader(FileName=[path]))
    shares = fetch(simple.ProcessIdScalars(Input=ridge))
    mesh = arrays(shares)
    ids = shares.GetPointData().GetGlobalIds()
    ids = vtk_to_numpy(ids) if ids else np.arange(len(mesh["points"]))
    found = merged(mesh, ids)
    table = columns(fetch(simple.MidSurfaceStatistics(Input=ridge)))
    found.update({f"table: {name}": values for name, values in table.items()})
    # The large sheet, and the small one.
    rows = [np.flatnonzero(table["Component"] == component)[0] for component in (0, 1)]
    assert list(table["EulerNumber"][rows]) == [0, 1], table["EulerNumber"]
    assert list(table["BoundaryLoops"][rows]) == [2, 1], table["BoundaryLoops"]
    if processes == 1:
        np.savez(path + ".npz", **found)
    else:
        corners = mesh["polys"].reshape(-1, 3)[mesh["cell Component"] == 0]
        workers = vtk_to_numpy(shares.GetPointData().GetArray("ProcessId"))[corners[:, 0]]
        assert len(set(workers)) == processes, set(workers)
        np.testing.assert_array_equal(np.unique(ids), np.arange(len(found["points"])))
        expected = np.load(path + ".npz")
        assert sorted(found) == sorted(expected.files), set(found) ^ set(expected.files)
        for name in expected.files:
            np.testing.assert_array_equal(found[name], expected[name], err_msg=name)
    print(f"the same with {processes} processes")


if __name__ == "__main__":
    main()
