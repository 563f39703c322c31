"""Measures the memory of several processes that share a volume of a thousand million voxels.

    mpiexec -n 4 pvbatch --symmetric benchmarks/processes.py PLUGIN FOLDER vesicles

The volume, 1024 x 1024 x 1024 bytes with 48 vesicles, or with one wavy sheet where the last word is
`sheet`, is written to FOLDER where it is not there yet (with one process). Each process prints its peak
memory beyond ParaView: its part of the volume and its share of the work; and the seconds of the filter
alone, by the clock and of its own processors. The first prints what the table says of all.

The volume is read before the clock starts, and ParaView has looked through it by then: for the list of
arrays to choose from it asks the ranges of all values, as it does for any filter that has such a list,
which takes much longer than reading labels.
"""
import sys
import time
from pathlib import Path

import numpy as np
from paraview import simple
from vtkmodules.vtkParallelCore import vtkMultiProcessController

SIDE = 1024
VESICLES = 48
# Each vesicle has a cube of the volume to itself.
CELL = 128
RADIUS, THICKNESS = 40.0, 4.0


def vesicle():
    z, y, x = np.mgrid[:CELL, :CELL, :CELL] - 0.5 * CELL
    return (abs(np.sqrt(x * x + y * y + z * z) - RADIUS) <= 0.5 * THICKNESS).astype(np.uint8)


def write_sheet(volume):
    y, x = np.mgrid[:SIDE, :SIDE]
    height = 0.5 * SIDE + 40 * np.sin(x / 150) * np.cos(y / 170)
    for z in range(SIDE // 2 - 64, SIDE // 2 + 64):
        volume[z] = abs(z - height) <= 4.5


def write_vesicles(volume):
    cells = SIDE // CELL
    # A step without a common divisor spreads them evenly.
    for cell in (11 * np.arange(VESICLES)) % cells**3:
        z, y, x = (CELL * np.array(np.unravel_index(cell, (cells,) * 3))).tolist()
        volume[z : z + CELL, y : y + CELL, x : x + CELL] = vesicle()


def memory(field):
    """A field of /proc/self/status in MB."""
    with open("/proc/self/status") as status:
        line = next(line for line in status if line.startswith(field + ":"))
    return int(line.split()[1]) / 1000


def main():
    plugin, folder, content = sys.argv[1:]
    controller = vtkMultiProcessController.GetGlobalController()
    path = Path(folder) / f"{content}.raw"
    if not path.exists():
        assert controller.GetNumberOfProcesses() == 1, "write the volume with one process first"
        volume = np.memmap(path, np.uint8, "w+", shape=(SIDE, SIDE, SIDE))
        {"vesicles": write_vesicles, "sheet": write_sheet}[content](volume)
        volume.flush()
        del volume
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    before = memory("VmRSS")
    reader = simple.ImageReader(
        FileNames=[str(path)],
        FileDimensionality=3,
        DataScalarType="unsigned char",
        DataExtent=[0, SIDE - 1] * 3,
    )
    reader.UpdatePipeline()
    mesh = simple.MidSurface(Input=reader)
    clocks = (time.perf_counter, time.process_time)
    start = [clock() for clock in clocks]
    mesh.UpdatePipeline()
    seconds, processor = (clock() - begin for clock, begin in zip(clocks, start))
    piece = mesh.GetClientSideObject().GetOutputDataObject(0)
    print(
        f"process {controller.GetLocalProcessId()} of {controller.GetNumberOfProcesses()}: "
        f"{memory('VmHWM') - before:.0f} MB, {seconds:.0f} s, {processor:.0f} s of processor time, "
        f"{piece.GetNumberOfCells():,} triangles",
        flush=True,
    )
    statistics = simple.MidSurfaceStatistics(Input=mesh)
    statistics.UpdatePipeline()
    table = statistics.GetClientSideObject().GetOutputDataObject(0)
    if table.GetNumberOfRows() > 0:
        names = ("Points", "Triangles", "EulerNumber", "BoundaryLoops", "V567")
        print(*(f"{name} {table.GetValueByName(0, name)}" for name in names), sep=", ", flush=True)


if __name__ == "__main__":
    main()
