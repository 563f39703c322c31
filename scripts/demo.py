"""Runs the Mid-Surface filter on a segmented volume; writes the mesh and a picture of it.

    pvpython demo.py PLUGIN VOLUME FOLDER

Prints a table: a line a label, with the figures of the label's mesh.
"""

import os
import sys
import time

import numpy as np
from paraview import servermanager, simple
from vtk.util.numpy_support import vtk_to_numpy

# Colour-blind safe, the first two for the outer and the inner membrane of the sample.
LABEL_COLOURS = [
    (0.90, 0.62, 0.00), (0.00, 0.45, 0.70), (0.00, 0.62, 0.45), (0.80, 0.47, 0.65),
    (0.34, 0.71, 0.91), (0.84, 0.37, 0.00), (0.94, 0.89, 0.26), (0.50, 0.50, 0.50),
]
MOST_LABELS_LISTED = 12


def extract(volume_file):
    """The filter's proxy, its mesh and the seconds it took."""
    try:
        reader = simple.OpenDataFile(volume_file)
    except RuntimeError as error:
        sys.exit(f"demo.py: ParaView cannot open this file: {error}")
    simple.UpdatePipeline(proxy=reader)
    mid_surface = simple.MidSurface(Input=reader)
    start = time.perf_counter()
    simple.UpdatePipeline(proxy=mid_surface)
    seconds = time.perf_counter() - start
    mesh = servermanager.Fetch(mid_surface)
    if mesh is None or mesh.GetNumberOfCells() == 0:
        sys.exit(f"demo.py: no mesh was made of {volume_file}; the messages above say why")
    return mid_surface, mesh, seconds


def triangle_figures(points, triangles):
    """Area, quality (1: equilateral) and smallest angle in degrees of each triangle."""
    corners = points[triangles].astype(float)
    edges = np.roll(corners, -1, axis=1) - corners
    lengths = np.sort(np.linalg.norm(edges, axis=2), axis=1)
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    quality = 6 / np.sqrt(3) * area / (0.5 * lengths.sum(axis=1) * lengths[:, 2])
    a, b, c = lengths.T
    cosine = (b * b + c * c - a * a) / (2 * b * c)
    return area, quality, np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def print_table(mesh, seconds):
    points = vtk_to_numpy(mesh.GetPoints().GetData())
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    labels = vtk_to_numpy(mesh.GetCellData().GetArray("Label"))
    components = vtk_to_numpy(mesh.GetCellData().GetArray("Component"))
    area, quality, angle = triangle_figures(points, triangles)

    titles = ("label", "components", "points", "triangles", "area", "quality", "smallest angle")
    print(" | ".join(f"{t:>10}" for t in titles))

    def line(name, chosen, count):
        used = len(np.unique(triangles[chosen]))
        print(
            f"{name:>10} | {count:10d} | {used:10d} | {chosen.sum():10d} | {area[chosen].sum():10.4g}"
            f" | {quality[chosen].mean():10.3f} | {angle[chosen].mean():10.1f} deg"
        )

    found = np.unique(labels)
    for label in found[:MOST_LABELS_LISTED]:
        chosen = labels == label
        line(str(label), chosen, len(np.unique(components[chosen])))
    if len(found) > MOST_LABELS_LISTED:
        print(f"... and {len(found) - MOST_LABELS_LISTED} labels more")
    pairs = np.unique(np.stack([labels, components], axis=1), axis=0)
    line("all", np.ones(len(labels), bool), len(pairs))
    print(
        f"\nseconds: {seconds:.2f} (the filter alone). Area in the volume's units squared; quality"
        " is 1 and\nthe smallest angle 60 degrees for equilateral triangles, both as means."
    )


def colour(display, mid_surface, mesh):
    """By label where there are several, else by thickness, with a legend."""
    labels = np.unique(vtk_to_numpy(mesh.GetCellData().GetArray("Label")))
    if len(labels) > 1:
        simple.ColorBy(display, ("CELLS", "Label"))
        table = simple.GetColorTransferFunction("Label")
        table.InterpretValuesAsCategories = 1
        table.Annotations = [text for label in labels for text in (str(label), f"Label {label}")]
        colours = [LABEL_COLOURS[n % len(LABEL_COLOURS)] for n in range(len(labels))]
        table.IndexedColors = [channel for colour in colours for channel in colour]
        return table, len(labels) <= MOST_LABELS_LISTED
    simple.ColorBy(display, ("POINTS", "Thickness"))
    table = simple.GetColorTransferFunction("Thickness")
    table.ApplyPreset("Viridis (matplotlib)", True)
    # A few blobs must not use up the scale.
    thickness = vtk_to_numpy(mesh.GetPointData().GetArray("Thickness"))
    low, high = np.percentile(thickness, [1, 99])
    table.RescaleTransferFunction(low, max(high, low + 1e-3 * abs(low) + 1e-6))
    return table, True


def aim(view, mesh):
    """Looks down along z at a slant, as close as the whole mesh fits into the picture."""
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    size = np.ptp(points, axis=0)
    towards = np.array([0.25, -0.75, 1.0] if size[0] >= size[1] else [-0.75, 0.25, 1.0])
    towards /= np.linalg.norm(towards)
    right = np.cross([0, 0, 1], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)

    middle = points.mean(axis=0)
    for axis in (right, up):
        along = (points - middle) @ axis
        middle += 0.5 * (along.min() + along.max()) * axis
    half_angle = np.radians(15)
    height = np.tan(half_angle) * 0.9
    width = height * view.ViewSize[0] / view.ViewSize[1] * 0.85  # room for the legend
    from_middle = points - middle
    distance = np.max(
        from_middle @ towards
        + np.maximum(np.abs(from_middle @ up) / height, np.abs(from_middle @ right) / width)
    )
    view.CameraViewAngle = 2 * np.degrees(half_angle)
    view.CameraPosition = list(middle + distance * towards)
    view.CameraFocalPoint = list(middle)
    view.CameraViewUp = list(up)


def draw(mid_surface, mesh, picture):
    view = simple.CreateView("RenderView")
    view.ViewSize = [1600, 1000]
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode = "Single Color"
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    display = simple.Show(mid_surface, view)
    display.Specular = 0.2
    # A key light from the camera's side and much fill: no face of a membrane may go black.
    view.KeyLightElevation, view.KeyLightIntensity = 30, 0.85
    view.FillLightKFRatio = view.HeadLightKHRatio = 1.6
    table, legend = colour(display, mid_surface, mesh)
    bar = simple.GetScalarBar(table, view)
    bar.TitleColor = bar.LabelColor = [0.15, 0.15, 0.15]
    bar.Title = "" if table.InterpretValuesAsCategories else "Thickness"
    bar.ComponentTitle = ""
    bar.RangeLabelFormat = "%.3g"
    bar.TitleFontSize = bar.LabelFontSize = 20
    bar.ScalarBarLength = 0.3 if bar.Title else 0.03 * len(table.Annotations)
    bar.WindowLocation = "Upper Right Corner"
    display.SetScalarBarVisibility(view, legend)
    aim(view, mesh)
    simple.SaveScreenshot(picture, view, ImageResolution=[1600, 1000])


def main():
    plugin, volume_file, folder = sys.argv[1:]
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    mid_surface, mesh, seconds = extract(volume_file)
    name = os.path.splitext(os.path.basename(volume_file))[0]
    mesh_file = os.path.join(folder, f"{name}-mid-surface.vtp")
    picture = os.path.join(folder, f"{name}-mid-surface.png")
    # Appended data, the default, is what Debian's ParaView cannot read back.
    simple.SaveData(mesh_file, proxy=mid_surface, DataMode="Binary", CompressorType="ZLib")
    draw(mid_surface, mesh, picture)
    print_table(mesh, seconds)
    print(f"\nmesh:    {mesh_file}\npicture: {picture}")


main()
