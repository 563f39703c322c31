"""Measures the whole Mid-Surface filter in ParaView on real volumes.

    pvpython benchmarks/filter.py PLUGIN FOLDER [VOLUME ...]

PLUGIN is the built MidSurface.so, FOLDER holds Fig13A.vti, Fig13B.vti, Fig7.vti, Fig11-OMM.vti and
Fig11-IMM.vti. Each volume has a process of its own, so that its memory is its own, too.

Both methods are measured. Seconds: wall time of the filter alone, its input already read, the
median of three runs, each with a new filter. Contour: ParaView's own filter at 0.5, measured in the
same way. Memory: the peak beyond what the process held before the first run, so beyond ParaView and
the input. A second table says what share of its time each stage takes in a run with one thread, by the filter's
own progress.
"""
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from datetime import date

import numpy as np

RUNS = 3
METHODS = ("Ridge surface", "Polyline zipper")

# arXiv 2405.19339, its table: seconds for lines and mesh, vertices, Q, smallest angle, share of all
# vertices with 5 to 7 edges.
PAPER = {
    "Fig13A": (2 + 1, 10_409, 0.82, 43.9, 97),
    "Fig13B": (4 + 4, 39_796, 0.81, 44.0, 97),
    "Fig7": (14 + 12, 69_939, 0.83, 44.6, 97),
    "Fig11-OMM": (283 + 40, 150_234, 0.79, 42.6, 92),
    "Fig11-IMM": (332 + 130, 289_088, 0.78, 41.3, 89),
}
# The paper's plugin, measured in ParaView 5.11 on a 2-core machine under load: seconds, MB, points,
# Q, smallest angle, share of interior points with 5 to 7 edges.
PLUGIN = {
    "Fig13A": (4.0, 384, 10_418, 0.816, 43.8, 99.89),
    "Fig13B": (27, 619, 39_944, 0.830, 45.3, 99.99),
    "Fig7": (128, 1_735, 70_038, 0.829, 45.1, 99.99),
    "Fig11-OMM": (1_370, 6_502, 153_617, 0.805, 43.5, 99.95),
    "Fig11-IMM": (1_754, 5_991, 300_873, 0.788, 42.0, 99.88),
}


def memory(field):
    """A field of /proc/self/status in MB."""
    with open("/proc/self/status") as status:
        line = next(line for line in status if line.startswith(field + ":"))
    return int(line.split()[1]) / 1000


def reset_peak():
    with open("/proc/self/clear_refs", "w") as control:
        control.write("5")


def timed(make, keep):
    """Median seconds of a filter's update, what `keep` returns for the last run's output, and the
    peak memory in MB beyond the first run's start."""
    from paraview import simple

    seconds, kept, peak = [], None, None
    for _ in range(RUNS):
        proxy = make()
        reset_peak()
        before = memory("VmRSS")
        start = time.perf_counter()
        proxy.UpdatePipeline()
        seconds.append(time.perf_counter() - start)
        if peak is None:
            peak = memory("VmHWM") - before
        kept = keep(proxy.GetClientSideObject().GetOutputDataObject(0))
        simple.Delete(proxy)
        del proxy
    return statistics.median(seconds), kept, peak


def stages(proxy):
    """Seconds of each stage of a filter's update, in the order of their first texts."""
    spent, now = {}, ["", time.perf_counter()]

    def turn(text):
        stage, since = now
        now[:] = text, time.perf_counter()
        spent[stage] = spent.get(stage, 0) + now[1] - since

    vtk_filter = proxy.GetClientSideObject()
    observer = vtk_filter.AddObserver(
        "ProgressEvent", lambda *_: turn(vtk_filter.GetProgressText() or "")
    )
    proxy.UpdatePipeline()
    vtk_filter.RemoveObserver(observer)
    turn("")
    spent.pop("")
    return spent


def figures(mesh):
    """Points, triangles, mean quality, mean smallest angle in degrees, and the share in per cent of
    the interior points that have five, six or seven edges."""
    from paraview.vtk.util.numpy_support import vtk_to_numpy

    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    corners = points[triangles]
    edges = np.roll(corners, -1, axis=1) - corners
    lengths = np.sort(np.linalg.norm(edges, axis=2), axis=1)
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    quality = 6 / np.sqrt(3) * area / (0.5 * lengths.sum(axis=1) * lengths[:, 2])
    a, b, c = lengths.T
    angle = np.degrees(np.arccos(np.clip((b * b + c * c - a * a) / (2 * b * c), -1, 1)))

    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]))
    sides, uses = np.unique(sides, axis=0, return_counts=True)
    valence = np.bincount(sides.ravel(), minlength=len(points))
    inside = np.ones(len(points), bool)
    inside[sides[uses == 1].ravel()] = False
    good = (valence[inside] >= 5) & (valence[inside] <= 7)
    return {
        "points": len(points),
        "triangles": len(triangles),
        "quality": quality.mean(),
        "angle": angle.mean(),
        "valence": 100 * good.mean(),
    }


def measure(plugin, path, method):
    """Measures one method on one volume in this process and prints the result as JSON."""
    from paraview import simple

    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    reader = simple.XMLImageDataReader(FileName=[path])
    reader.UpdatePipeline()
    array = reader.PointData.GetArray(0).Name
    seconds, result, peak = timed(
        lambda: simple.MidSurface(Input=reader, Method=method), figures
    )

    # With one worker one stage is at work at a time.
    stages_of_run = stages(simple.MidSurface(Input=reader, Method=method, Threads=1))

    def contour():
        return simple.Contour(Input=reader, ContourBy=["POINTS", array], Isosurfaces=[0.5])

    contour_seconds, _, _ = timed(contour, lambda mesh: None)
    measured = {"seconds": seconds, "peak": peak, "contour": contour_seconds}
    print(json.dumps({**measured, "stages": stages_of_run, **result}))


def measure_apart(plugin, path, method):
    """Measures one method on one volume in a process of its own."""
    command = ["pvpython", os.path.abspath(__file__), "--one", plugin, path, method]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{done.stderr}filter.py: {path} could not be measured")
    return json.loads(done.stdout.splitlines()[-1])


def processor():
    with open("/proc/cpuinfo") as lines:
        names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return f"{os.cpu_count()} cores, {names[0] if names else platform.machine()}"


TITLES = ("volume", "from", "seconds", "MB", "points", "triangles", "Q", "angle", "V567", "Contour s")
WIDTHS = (9, 21, 8, 6, 8, 9, 5, 5, 6, 9)


def print_row(*cells, widths=WIDTHS):
    print("| " + " | ".join(f"{cell:>{width}}" for cell, width in zip(cells, widths)) + " |", flush=True)


def print_stages(method, stages_of):
    """A table of the stages' shares in per cent, a column a volume."""
    widths = (25, *(9 for _ in stages_of))
    print(f"\n{method}: share of the time in each stage, %\n")
    print_row("stage", *stages_of, widths=widths)
    print_row(*("-" * width for width in widths), widths=widths)
    names = {name: None for stages in stages_of.values() for name in stages}
    for name in names:
        shares = [100 * s.get(name, 0) / sum(s.values()) for s in stages_of.values()]
        print_row(name, *(f"{share:.0f}" for share in shares), widths=widths)


def main():
    if sys.argv[1:2] == ["--one"]:
        return measure(*sys.argv[2:])
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    plugin, folder = sys.argv[1:3]
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"{date.today()}, {processor()}; load before: {load}\n")
    print_row(*TITLES)
    print_row(*("-" * width for width in WIDTHS))
    stages_of = {method: {} for method in METHODS}
    for name in sys.argv[3:] or PAPER:
        path = os.path.join(folder, name + ".vti")
        if not os.path.exists(path):
            print_row(name, "not there", *[""] * 8)
            continue
        for method in METHODS:
            m = measure_apart(plugin, path, method)
            stages_of[method][name] = m["stages"]
            print_row(
                name, method, f"{m['seconds']:.2f}", f"{m['peak']:.0f}", m["points"], m["triangles"],
                f"{m['quality']:.3f}", f"{m['angle']:.1f}", f"{m['valence']:.2f}", f"{m['contour']:.2f}",
            )
        seconds, points, quality, angle, valence = PAPER[name]
        print_row("", "paper", seconds, "", points, "", f"{quality:.2f}", angle, f"{valence} *", "")
        seconds, peak, points, quality, angle, valence = PLUGIN[name]
        print_row(
            "", "its plugin, measured", f"{seconds:g}", peak, points, "", f"{quality:.3f}", angle,
            f"{valence:.2f}", "",
        )
    print(
        "\nQ: mean quality, 1 for equilateral triangles. angle: mean smallest angle, degrees. V567: % of"
        "\nthe interior points with 5 to 7 edges (* of all points). paper: arXiv 2405.19339, its table,"
        "\nseconds for lines and mesh on its machine. its plugin, measured: on 2 cores under load."
    )
    for method in METHODS:
        print_stages(method, stages_of[method])


main()
