"""Mid-Surface Statistics: a table of any triangle mesh."""
import math

import numpy as np
from paraview import simple
from paraview.vtk import vtkMultiBlockDataSet
from vtkmodules.vtkCommonCore import vtkStringArray

from pipeline import FilterTest, arrays, image, run_tests, sheets, source, tube, update


def text_of(value):
    """A vtkVariant as text; its own has six digits, too few to add up."""
    return value.ToString() if value.IsString() else f"{value.ToDouble():.17g}"


def rows_of(table):
    """The rows of a vtkTable as dictionaries by column."""
    names = [table.GetColumnName(index) for index in range(table.GetNumberOfColumns())]
    return [
        {name: text_of(table.GetValueByName(row, name)) for name in names}
        for row in range(table.GetNumberOfRows())
    ]


class Statistics(FilterTest):
    def measure(self, proxy):
        table, messages = update(simple.MidSurfaceStatistics(Input=proxy))
        self.assertEqual(messages.errors + messages.warnings, [])
        return rows_of(table)

    def numbers(self, row):
        return {name: float(text) for name, text in row.items() if name != "Of"}

    def test_rows_and_columns(self):
        rows = self.measure(simple.MidSurface(Input=source(image(sheets()))))
        self.assertEqual(
            [row["Of"] for row in rows],
            "total,label 1,component 0,label 2,component 1,label 3,component 2".split(","),
        )
        self.assertEqual(
            ",".join(rows[0]),
            "Of,Label,Component,Points,Triangles,Area,Closed,EulerNumber,BoundaryLength,"
            "BoundaryLoops,ThicknessMean,Thickness5,Thickness25,ThicknessMedian,Thickness75,"
            "Thickness95,Qmin,Qavg,MeanSmallestAngle,ShareUnder30,ShareOver120,V567",
        )
        self.assertTrue(math.isnan(self.numbers(rows[0])["Label"]))
        self.assertEqual([row["Label"] for row in rows[1:]], list("112233"))
        self.assertEqual([row["Component"] for row in rows[2::2]], list("012"))
        total = self.numbers(rows[0])
        for name in ("Points", "Triangles", "Area", "EulerNumber", "BoundaryLoops"):
            parts = sum(self.numbers(row)[name] for row in rows[1::2])
            self.assertAlmostEqual(total[name], parts, delta=1e-6 * parts)

    def test_figures_of_a_known_sheet(self):
        proxy = simple.MidSurface(Input=source(image(sheets(labels=(5,)))))
        mesh = arrays(update(proxy)[0])
        row = self.numbers(self.measure(proxy)[1])
        self.assertEqual(row["Points"], len(mesh["points"]))
        self.assertEqual(row["Triangles"], len(mesh["cell Label"]))
        self.assertEqual((row["Closed"], row["EulerNumber"], row["BoundaryLoops"]), (0, 1, 1))
        # 20 voxels wide and 10 high, of which the surface ends on the outermost slices.
        self.assertAlmostEqual(row["Area"], 20 * 9, delta=20)
        self.assertAlmostEqual(row["BoundaryLength"], 58, delta=5)
        thickness = np.sort(mesh["point Thickness"])
        self.assertAlmostEqual(row["ThicknessMean"], thickness.mean(), delta=1e-4)
        for name, share in (("Thickness5", 5), ("ThicknessMedian", 50), ("Thickness95", 95)):
            self.assertAlmostEqual(row[name], np.percentile(thickness, share), delta=1e-4)
        self.assertTrue(0 < row["Qmin"] <= row["Qavg"] <= 1)
        self.assertTrue(30 < row["MeanSmallestAngle"] <= 60)

    def test_any_triangle_mesh(self):
        sphere = simple.Sphere(ThetaResolution=40, PhiResolution=30, Radius=10)
        (row,) = self.measure(sphere)
        row = self.numbers(row)
        self.assertEqual((row["Closed"], row["EulerNumber"], row["BoundaryLoops"]), (1, 2, 0))
        self.assertAlmostEqual(row["Area"], 4 * math.pi * 100, delta=20)
        self.assertTrue(math.isnan(row["ThicknessMean"]))

    def test_polygons_are_refused_with_a_remedy(self):
        box = simple.Box()
        table, messages = update(simple.MidSurfaceStatistics(Input=box))
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("Triangulate", messages.errors[0])
        self.assertEqual(table.GetNumberOfRows(), 0)
        self.assertEqual(len(self.measure(simple.Triangulate(Input=box))), 1)

    def test_an_empty_mesh_has_an_empty_total(self):
        proxy = simple.MidSurface(Input=source(image(sheets() * 0)))
        (row,) = self.measure(proxy)
        self.assertEqual(self.numbers(row)["Triangles"], 0)

    def test_names_of_labels(self):
        data = image(sheets())
        names = vtkStringArray()
        names.SetName("LabelNames")
        for name in ("", "äußere", "innere", "ER"):
            names.InsertNextValue(name)
        data.GetFieldData().AddArray(names)
        rows = self.measure(simple.MidSurface(Input=source(data)))
        self.assertEqual(rows[1]["Of"], "label 1: äußere")

    def test_a_table_for_each_block(self):
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, image(sheets(labels=(1,))))
        blocks.SetBlock(1, image(tube()))
        tables, _ = update(
            simple.MidSurfaceStatistics(Input=simple.MidSurface(Input=source(blocks)))
        )
        loops = [rows_of(tables.GetBlock(index))[0]["BoundaryLoops"] for index in (0, 1)]
        self.assertEqual(loops, ["1", "2"])


if __name__ == "__main__":
    run_tests()
