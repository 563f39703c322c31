"""Runs every script of examples/paraview on a small mitochondrion and looks at what it wrote."""

import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

PLUGIN, SAMPLE, PVPYTHON = sys.argv[1:]
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "paraview"


def read(reader, file):
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


class ExamplesTest(unittest.TestCase):
    """Each test runs the script of its name."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        # Not there yet, as in the README's command.
        self.folder = pathlib.Path(folder.name) / "results"

    def run_example(self, name, *more):
        result = subprocess.run(
            [PVPYTHON, EXAMPLES / f"{name}.py", PLUGIN, SAMPLE, self.folder, *more],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertNotIn("ERR|", result.stdout)
        return result.stdout

    def rows(self, name):
        with open(self.folder / name, newline="") as file:
            return list(csv.DictReader(file))

    def test_every_script_has_a_test(self):
        scripts = {f"test_{script.stem}" for script in EXAMPLES.glob("*.py")}
        self.assertEqual(scripts, {name for name in dir(self) if name in scripts})

    def test_quantify(self):
        self.assertIn("voxel size: (1.0, 1.0, 1.0)", self.run_example("quantify"))
        mesh = read(vtkXMLPolyDataReader(), self.folder / "mid-surface.vtp")
        rows = self.rows("pieces.csv")
        self.assertEqual([row["Of"] for row in rows if "component" not in row["Of"]],
                         ["total", "label 1", "label 2"])
        pieces = [row for row in rows if "component" in row["Of"]]
        self.assertEqual({float(piece["Label"]) for piece in pieces}, {1, 2})
        corners = points(mesh)[vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = 0.5 * np.linalg.norm(normals, axis=1).sum()
        self.assertAlmostEqual(float(rows[0]["Area"]) / area, 1, places=4)
        self.assertAlmostEqual(sum(float(piece["Area"]) for piece in pieces) / area, 1, places=4)
        for piece in pieces:
            self.assertTrue(1 < float(piece["ThicknessMedian"]) < 10, piece)

    def test_hand_over(self):
        self.run_example("quantify")
        self.run_example("hand_over", "0.1")
        whole = read(vtkXMLPolyDataReader(), self.folder / "mid-surface.vtp")
        labels = vtk_to_numpy(whole.GetCellData().GetArray("Label"))
        triangles = vtk_to_numpy(whole.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        thickness = vtk_to_numpy(whole.GetPointData().GetArray("Thickness"))
        for label in (1, 2):
            used = np.unique(triangles[labels == label])
            ply = read(vtkPLYReader(), self.folder / f"label-{label}.ply")
            vtp = read(vtkXMLPolyDataReader(), self.folder / f"label-{label}.vtp")
            vtu = read(vtkXMLUnstructuredGridReader(), self.folder / f"label-{label}.vtu")
            for mesh in (ply, vtp, vtu):
                self.assertEqual(mesh.GetNumberOfCells(), (labels == label).sum())
                self.assertEqual(mesh.GetNumberOfPoints(), len(used))
                for side in (np.min, np.max):
                    expected = 0.1 * side(points(whole)[used], axis=0)
                    np.testing.assert_allclose(side(points(mesh), axis=0), expected, rtol=1e-5)
            scaled = vtk_to_numpy(vtp.GetPointData().GetArray("Thickness"))
            self.assertAlmostEqual(scaled.mean() / thickness[used].mean(), 0.1, places=5)
            normals = vtk_to_numpy(vtp.GetPointData().GetArray("Normals"))
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-4)

    def test_lipids(self):
        self.run_example("lipids")
        heads = self.rows("heads.csv")
        half = len(heads) // 2
        self.assertGreater(half, 1000)
        for outer, inner in zip(heads[:half:100], heads[half::100]):
            between = [float(outer[f"Points:{axis}"]) - float(inner[f"Points:{axis}"])
                       for axis in range(3)]
            self.assertAlmostEqual(np.linalg.norm(between), float(outer["Thickness"]), places=2)
            towards = [float(inner[f"Direction:{axis}"]) for axis in range(3)]
            self.assertGreater(np.dot(between, towards), 0, "a lipid points away from the middle")
        self.assertGreater(
            read(vtkXMLPolyDataReader(), self.folder / "lipids.vtp").GetNumberOfCells(), 1000)

    def test_curvature_and_distance(self):
        self.run_example("curvature_and_distance", "2", "1")
        fields = read(vtkXMLPolyDataReader(), self.folder / "measured.vtp").GetPointData()
        distance = vtk_to_numpy(fields.GetArray("Distance"))
        self.assertTrue(2 < distance.min() < distance.max() < 96, (distance.min(), distance.max()))
        curvature = vtk_to_numpy(fields.GetArray("Mean_Curvature"))
        self.assertTrue(0.001 < np.median(abs(curvature)) < 1, np.median(abs(curvature)))


unittest.main(argv=sys.argv[:1], verbosity=2)
