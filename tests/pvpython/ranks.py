"""Several processes: all of them together give what one gives.

`pvpython ranks.py write PLUGIN VOLUME` writes a volume, and beside it what one process makes of it.
`mpiexec -n 3 pvbatch ranks.py check PLUGIN VOLUME` compares, and so does
`pvpython ranks.py check PLUGIN VOLUME PORT` as the client of a pvserver of several processes.
"""
import sys

import numpy as np
from paraview import servermanager, simple

from pipeline import arrays, image, update
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

LABELS = ["-7", "1", "200"]


def write_volumes(path):
    """A sheet that lies flat, a sphere through the middle of the volume, and an upright sheet; on
    points, and on cells in another file."""
    z, y, x = np.mgrid[:40, :44, :48]
    volume = np.zeros(x.shape, np.int16)
    volume[2:6, 4:40, 4:44] = -7
    volume[abs(np.sqrt((x - 20.3) ** 2 + (y - 21.1) ** 2 + (z - 23.2) ** 2) - 12) < 2.2] = 1
    volume[10:, 4:40, 40:44] = 200
    for name, data in ((path, image(volume)), (path + ".cells.vti", image(volume, cells=True))):
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(name)
        writer.SetInputData(data)
        writer.SetDataModeToBinary()
        writer.Write()


def fetch(proxy):
    """What all processes together have made."""
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy)


def lines_in_order(lines):
    """Every line with all that belongs to it, in an order of their own."""
    starts = lines["lines offsets"]
    on_points = np.column_stack(
        [lines["points"], lines["point Thickness"], lines["point BorderDistance"]]
    )
    on_lines = np.column_stack([lines[f"cell {name}"] for name in ("Label", "Component", "Slice")])
    of_line = [
        np.concatenate([own, on_points[lines["lines"][start:end]].ravel()])
        for own, start, end in zip(on_lines, starts, starts[1:])
    ]
    return {"lines": np.concatenate(sorted(of_line, key=lambda line: line.tobytes()))}


def in_order(mesh):
    """The arrays of a mesh, its triangles with all that belongs to them in an order of their own."""
    if "point Normals" not in mesh:
        return lines_in_order(mesh)
    on_points = [mesh["points"], mesh["point Normals"], mesh["point Thickness"][:, None]]
    corners = np.hstack(on_points)[mesh["polys"]].reshape(len(mesh["cell Label"]), -1)
    rows = np.column_stack([mesh["cell Label"], mesh["cell Component"], corners])
    return {
        "triangles": rows[np.lexsort(rows.T)],
        "number of points": np.array(len(mesh["points"])),
    }


def columns(table):
    """The columns of numbers of a vtkTable, by name."""
    data = table.GetRowData()
    names = [data.GetArrayName(index) for index in range(data.GetNumberOfArrays())]
    return {name: vtk_to_numpy(data.GetArray(name)) for name in names if data.GetArray(name)}


def integrals(proxy):
    """What Distance and RidgeField add up to, each part of the image counted once."""
    fields = fetch(simple.IntegrateVariables(Input=proxy)).GetPointData()
    return np.array([fields.GetArray(name).GetValue(0) for name in ("Distance", "RidgeField")])


def run_all(reader, on_cells):
    """Every filter's output, as numpy arrays by the filter's name and the array's."""
    ridge = simple.MidSurface(Input=reader)
    polylines = simple.MidPolylines(Input=reader)
    outputs = {
        "ridge surface": ridge,
        "zipper": simple.MidSurface(Input=reader, Method="Polyline zipper"),
        "polylines": polylines,
        "chain": simple.PolylineZipper(Input=polylines),
        "cells": simple.MidSurface(Input=on_cells),
    }
    found = {}
    for name, proxy in outputs.items():
        # As a window would: everything upstream is shown in parts, before and after.
        reader.UpdatePipeline()
        for array, values in in_order(arrays(fetch(proxy))).items():
            found[f"{name}: {array}"] = values
    for name, values in columns(fetch(simple.MidSurfaceStatistics(Input=ridge))).items():
        found[f"table: {name}"] = values
    found["field: sums"] = integrals(simple.RidgeField(Input=reader))
    return found


def check_labels(reader):
    proxy = simple.MidSurface(Input=reader)
    proxy.UpdatePipelineInformation()
    assert list(proxy.Labels.Available) == LABELS, list(proxy.Labels.Available)
    assert list(proxy.Labels) == LABELS, list(proxy.Labels)
    for chosen in (["200"], ["-7"], LABELS):
        proxy.Labels = chosen
        proxy.UpdatePipeline()
        low, high = proxy.CellData["Label"].GetRange(0)
        assert (low, high) == (int(chosen[0]), int(chosen[-1])), (low, high, chosen)


def check_that_all_work(reader, processes):
    """Each of the three components is worked on by another process."""
    shares = fetch(simple.ProcessIdScalars(Input=simple.MidSurface(Input=reader)))
    owners = vtk_to_numpy(shares.GetPointData().GetArray("ProcessId"))
    assert len(set(owners)) == min(processes, 3), set(owners)


def check_global_ids(reader, processes):
    """All points and triangles are numbered through; with one process there is no need."""
    for proxy in (
        simple.MidSurface(Input=reader),
        simple.PolylineZipper(Input=simple.MidPolylines(Input=reader)),
    ):
        mesh = fetch(proxy)
        for data in (mesh.GetPointData(), mesh.GetCellData()):
            ids = data.GetGlobalIds()
            assert (ids is not None) == (processes > 1)
            if ids:
                numbers = np.sort(vtk_to_numpy(ids))
                np.testing.assert_array_equal(numbers, np.arange(ids.GetNumberOfTuples()))


def check_unequal_blocks():
    """A collection of three meshes, of which the processes hold unequal numbers: a table of each."""
    source = simple.ProgrammableSource(
        OutputDataSetType="vtkMultiblockDataSet",
        Script="""
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkParallelCore import vtkMultiProcessController
controller = vtkMultiProcessController.GetGlobalController()
output.SetNumberOfBlocks(3)
for index in range(3):
    if index % controller.GetNumberOfProcesses() == controller.GetLocalProcessId():
        sphere = vtkSphereSource()
        sphere.Update()
        output.SetBlock(index, sphere.GetOutput())
""",
    )
    source.UpdatePipeline()
    table = simple.MidSurfaceStatistics(Input=source)
    table.UpdatePipeline()
    assert table.GetDataInformation().GetNumberOfRows() == 3


def check_that_nobody_waits(reader):
    """A run that fails in one process leaves the others as they should be."""
    proxy = simple.MidSurface(Input=reader, Labels=["9"])
    table = simple.MidSurfaceStatistics(Input=proxy)
    for _ in range(2):
        table.UpdatePipeline()
        assert proxy.GetDataInformation().GetNumberOfCells() == 0
    proxy.Labels = ["1"]
    table.UpdatePipeline()
    assert proxy.GetDataInformation().GetNumberOfCells() > 0


def check_that_an_unreadable_array_is_explained(reader):
    """A label is asked for of an array that holds none: the message tells what the array holds."""
    calculator = simple.Calculator(Input=reader, Function="0.37*labels", ResultArrayName="map")
    proxy = simple.MidSurface(Input=calculator, Segmentation=["POINTS", "map"], Labels=["1"])
    if proxy.GetClientSideObject():
        _, messages = update(proxy)
        assert "whole numbers" in messages.errors[0], messages.errors


def check_a_source_that_gives_fixed_parts(processes):
    """Each process says that its part is the whole: no surface, rather than one with seams."""
    source = simple.ProgrammableSource(
        OutputDataSetType="vtkImageData",
        ScriptRequestInformation="""
from vtkmodules.vtkParallelCore import vtkMultiProcessController
rank = vtkMultiProcessController.GetGlobalController().GetLocalProcessId()
extent = (0, 9, 0, 9, 9 * rank, 9 * rank + 9)
executive = self.GetExecutive()
executive.GetOutputInformation(0).Set(executive.WHOLE_EXTENT(), *extent)
""",
        Script="""
import numpy as np
from vtkmodules.vtkParallelCore import vtkMultiProcessController
rank = vtkMultiProcessController.GetGlobalController().GetLocalProcessId()
output.SetExtent(0, 9, 0, 9, 9 * rank, 9 * rank + 9)
labels = np.zeros((10, 10, 10), np.uint8)
labels[:, 4:7, :] = 1
output.PointData.append(labels.ravel(), "labels")
""",
    )
    source.UpdatePipeline()
    mesh = simple.MidSurface(Input=source)
    mesh.UpdatePipeline()
    assert (mesh.GetDataInformation().GetNumberOfCells() > 0) == (processes == 1)


def check(reader, on_cells, expected, processes):
    # With the reader's parts loaded each process has seen some labels only.
    reader.UpdatePipeline()
    check_labels(reader)
    found = run_all(reader, on_cells)
    assert sorted(found) == sorted(expected.files), set(found) ^ set(expected.files)
    for name in expected.files:
        if name == "field: sums":
            np.testing.assert_allclose(found[name], expected[name], rtol=1e-6)
        elif name.startswith("table"):
            # Sums of the same figures in another order.
            np.testing.assert_allclose(found[name], expected[name], rtol=1e-12)
        else:
            np.testing.assert_array_equal(found[name], expected[name], name)
    check_that_all_work(reader, processes)
    check_global_ids(reader, processes)
    check_that_nobody_waits(reader)
    check_unequal_blocks()
    check_that_an_unreadable_array_is_explained(reader)
    check_a_source_that_gives_fixed_parts(processes)
    print(f"the same with {processes} processes")


def main():
    task, plugin, volume, *port = sys.argv[1:]
    if port:
        simple.Connect("localhost", int(port[0]))
        simple.LoadPlugin(plugin, remote=True, ns=vars(simple))
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    if task == "write":
        write_volumes(volume)
    reader = simple.XMLImageDataReader(FileName=[volume])
    on_cells = simple.XMLImageDataReader(FileName=[volume + ".cells.vti"])
    if task == "write":
        np.savez(volume + ".npz", **run_all(reader, on_cells))
    else:
        processes = servermanager.ActiveConnection.GetNumberOfDataPartitions()
        check(reader, on_cells, np.load(volume + ".npz"), processes)


if __name__ == "__main__":
    main()
