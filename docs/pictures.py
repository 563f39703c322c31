"""Draws the pictures of the README.

    cargo run -p phantoms --release --bin make-sample -- mitochondrion.vti
    xvfb-run -a pvpython --force-offscreen-rendering docs/pictures.py PLUGIN mitochondrion.vti docs

Writes into the folder named last: mitochondrion.png (coloured by label), thickness.png (by
thickness), mesh.png (its triangles, close up), vesicle-polyline-zipper.png and
vesicle-ridge-surface.png (the same closed vesicle by both methods).
"""

import os
import sys

import numpy as np
from paraview import servermanager, simple
from paraview.vtk import vtkImageData
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

OUTER, INNER = (0.90, 0.62, 0.00), (0.00, 0.45, 0.70)


def vesicle(size=64, radius=22.0, thickness=5.0, noise=0.05):
    """A closed vesicle, label 1, with some of the voxels at its faces flipped."""
    axis = np.arange(size) - (size - 1) / 2
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    depth = abs(np.sqrt(x * x + y * y + z * z) - radius) - thickness / 2
    labels = depth <= 0
    at_faces = abs(depth) < 0.5
    labels ^= at_faces & (np.random.default_rng(1).random(labels.shape) < noise)
    image = vtkImageData()
    image.SetDimensions(size, size, size)
    array = numpy_to_vtk(labels.astype(np.uint8).ravel(), deep=True)
    array.SetName("Labels")
    image.GetPointData().SetScalars(array)
    source = simple.TrivialProducer()
    source.GetClientSideObject().SetOutput(image)
    source.UpdatePipeline()
    return source


def make_view(width, height):
    view = simple.CreateView("RenderView")
    view.ViewSize = [width, height]
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode = "Single Color"
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    # A key light from the camera's side and much fill: no face of a membrane may go black.
    view.KeyLightElevation, view.KeyLightIntensity = 30, 0.85
    view.FillLightKFRatio = view.HeadLightKHRatio = 1.6
    return view


def look(view, towards, zoom):
    """From the direction `towards`, z up, nearer than what shows everything by the factor `zoom`."""
    view.CameraPosition, view.CameraFocalPoint = towards, [0, 0, 0]
    view.CameraViewUp = [0, 0, 1]
    view.ResetCamera()
    simple.GetActiveCamera().Zoom(zoom)


def save(view, folder, name):
    simple.SaveScreenshot(os.path.join(folder, name), view, ImageResolution=list(view.ViewSize))


def colour_by_label(display):
    simple.ColorBy(display, ("CELLS", "Label"))
    table = simple.GetColorTransferFunction("Label")
    table.InterpretValuesAsCategories = 1
    table.Annotations = ["1", "outer membrane", "2", "inner membrane"]
    table.IndexedColors = [*OUTER, *INNER]


def colour_by_thickness(display, mesh, view):
    thickness = vtk_to_numpy(servermanager.Fetch(mesh).GetPointData().GetArray("Thickness"))
    simple.ColorBy(display, ("POINTS", "Thickness"))
    table = simple.GetColorTransferFunction("Thickness")
    table.ApplyPreset("Viridis (matplotlib)", True)
    table.RescaleTransferFunction(*np.percentile(thickness, [2, 98]))
    bar = simple.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle, bar.RangeLabelFormat = "Thickness", "", "%.1f"
    bar.TitleColor = bar.LabelColor = [0.15, 0.15, 0.15]
    bar.TitleFontSize = bar.LabelFontSize = 20
    bar.WindowLocation = "Upper Right Corner"
    display.SetScalarBarVisibility(view, True)


def draw_mitochondrion(mesh, folder):
    view = make_view(1200, 750)
    display = simple.Show(mesh, view)
    display.Specular = 0.2
    colour_by_label(display)
    display.SetScalarBarVisibility(view, False)
    look(view, [0.4, -1.0, 1.1], 1.35)
    save(view, folder, "mitochondrion.png")
    colour_by_thickness(display, mesh, view)
    save(view, folder, "thickness.png")


def draw_mesh(mesh, folder):
    view = make_view(800, 560)
    display = simple.Show(mesh, view)
    display.SetRepresentationType("Surface With Edges")
    display.EdgeColor = [0.25, 0.25, 0.25]
    colour_by_label(display)
    display.SetScalarBarVisibility(view, False)
    look(view, [0.4, -1.0, 1.1], 7)
    save(view, folder, "mesh.png")


def draw_methods(folder):
    """A picture a method, of the same vesicle."""
    source = vesicle()
    for method in simple.MidSurface(Input=source).GetProperty("Method").Available:
        mesh = simple.MidSurface(Input=source, Method=method)
        view = make_view(500, 500)
        display = simple.Show(mesh, view)
        display.SetRepresentationType("Surface With Edges")
        display.EdgeColor = [0.25, 0.25, 0.25]
        colour_by_label(display)
        display.SetScalarBarVisibility(view, False)
        look(view, [0.5, -1.0, 1.3], 1.4)
        save(view, folder, f"vesicle-{method.lower().replace(' ', '-')}.png")


def main():
    plugin, volume, folder = sys.argv[1:]
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    segmentation = simple.OpenDataFile(volume)
    segmentation.UpdatePipeline()
    mesh = simple.MidSurface(Input=segmentation)
    mesh.UpdatePipeline()
    draw_mitochondrion(mesh, folder)
    draw_mesh(mesh, folder)
    draw_methods(folder)


main()
