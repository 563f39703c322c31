"""What the tests share: the plugin, label volumes made with numpy, and what comes out of filters.

Volumes are numpy arrays in the order (z, y, x), x fastest, as they lie in a vtkImageData.
"""
import os
import sys
import unittest
from pathlib import Path

import numpy as np
from paraview import servermanager, simple
from paraview.vtk import vtkImageData
from paraview.vtk.util import numpy_support
from vtkmodules.util.misc import calldata_type
from vtkmodules.vtkCommonCore import VTK_STRING

CHECKOUT = Path(__file__).resolve().parents[2]
# Real segmentations, where there are any.
DATA = Path(os.environ.get("MIDSURFACE_DATA", CHECKOUT.parent / "shared" / "data"))


def run_tests():
    """Loads the plugin that the command line names and runs the tests of the main module."""
    simple.LoadPlugin(sys.argv[1], remote=False, ns=vars(simple))
    unittest.main(argv=sys.argv[:1], verbosity=2)


def sheets(shape=(10, 30, 24), dtype=np.uint8, labels=(1, 2, 3)):
    """Upright sheets, 4 voxels thick, across x and z, one a label, and none touches another."""
    volume = np.zeros(shape, dtype)
    for index, label in enumerate(labels):
        volume[:, 3 + 9 * index : 7 + 9 * index, 2:-2] = label
    return volume


def tube(depth=12, radius=9.0, thickness=4.0):
    """A tube along z through both ends of the volume, label 1."""
    half = int(radius + thickness) + 2
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    slab = np.abs(np.hypot(x, y) - radius) <= thickness / 2
    return np.broadcast_to(slab, (depth, *slab.shape)).astype(np.uint8)


def image(volume, name="labels", cells=False):
    """A vtkImageData that holds `volume` as the only array."""
    result = vtkImageData()
    z, y, x = volume.shape[:3]
    result.SetDimensions(*((x + 1, y + 1, z + 1) if cells else (x, y, z)))
    add_array(result, volume, name, cells)
    return result


def add_array(target, volume, name, cells=False):
    values = volume.reshape(-1, volume.shape[3]) if volume.ndim == 4 else volume.ravel()
    array = numpy_support.numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    (target.GetCellData() if cells else target.GetPointData()).AddArray(array)


def source(data):
    """A pipeline source that hands out `data`."""
    producer = simple.TrivialProducer()
    producer.GetClientSideObject().SetOutput(data)
    producer.UpdatePipeline()
    return producer


class Messages:
    """Collects the errors and warnings of a filter proxy."""

    def __init__(self, proxy):
        self.errors, self.warnings = [], []

        @calldata_type(VTK_STRING)
        def on_error(caller, event, text):
            self.errors.append(text)

        @calldata_type(VTK_STRING)
        def on_warning(caller, event, text):
            self.warnings.append(text)

        algorithm = proxy.GetClientSideObject()
        algorithm.AddObserver("ErrorEvent", on_error)
        algorithm.AddObserver("WarningEvent", on_warning)


def update(proxy):
    """Runs a filter, asked twice for its output. Returns that and its messages."""
    messages = Messages(proxy)
    proxy.UpdatePipeline()
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy), messages


def arrays(data):
    """Points, connectivity and all arrays of a vtkPolyData, as numpy arrays by name."""
    result = {}
    if data.GetNumberOfPoints():
        result["points"] = numpy_support.vtk_to_numpy(data.GetPoints().GetData())
    for name, cells in (("polys", data.GetPolys()), ("lines", data.GetLines())):
        result[name] = numpy_support.vtk_to_numpy(cells.GetConnectivityArray())
        result[name + " offsets"] = numpy_support.vtk_to_numpy(cells.GetOffsetsArray())
    for kind, fields in (("point ", data.GetPointData()), ("cell ", data.GetCellData())):
        for index in range(fields.GetNumberOfArrays()):
            array = fields.GetArray(index)
            result[kind + array.GetName()] = numpy_support.vtk_to_numpy(array)
    return {name: values.copy() for name, values in result.items()}


def image_array(data, name, cells=False):
    """An array of a vtkImageData, in the order (z, y, x)."""
    fields = data.GetCellData() if cells else data.GetPointData()
    x, y, z = (n - 1 if cells and n > 1 else n for n in data.GetDimensions())
    return numpy_support.vtk_to_numpy(fields.GetArray(name)).reshape(z, y, x)


class FilterTest(unittest.TestCase):
    """A test case with the comparisons that several tests need."""

    def extract(self, data, expect_quiet=True, **properties):
        """The arrays of Mid-Surface's mesh of a vtkImageData."""
        mesh, messages = update(simple.MidSurface(Input=source(data), **properties))
        if expect_quiet:
            self.assertEqual((messages.errors, messages.warnings), ([], []))
        return arrays(mesh)

    def assert_same(self, first, second):
        self.assertEqual(sorted(first), sorted(second))
        for name, values in first.items():
            self.assertTrue(np.array_equal(values, second[name]), name)

    def assert_empty(self, data):
        """No points and no cells; an image keeps its extent but has no arrays."""
        if data.IsA("vtkImageData"):
            arrays = data.GetPointData(), data.GetCellData()
            self.assertEqual([fields.GetNumberOfArrays() for fields in arrays], [0, 0])
        else:
            self.assertEqual((data.GetNumberOfPoints(), data.GetNumberOfCells()), (0, 0))

    def tearDown(self):
        for proxy in list(simple.GetSources().values()):
            simple.Delete(proxy)
