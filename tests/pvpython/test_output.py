"""What the filters give."""
import numpy as np
from paraview import simple
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

from pipeline import (
    FilterTest,
    add_array,
    arrays,
    image,
    image_array,
    run_tests,
    sheets,
    source,
    tube,
    update,
)


def area(mesh):
    """Area of all triangles of a mesh as arrays."""
    a, b, c = (mesh["points"][mesh["polys"].reshape(-1, 3)[:, k]].astype(float) for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


class Mesh(FilterTest):
    def test_arrays(self):
        mesh = self.extract(image(sheets()))
        points, triangles = len(mesh["points"]), len(mesh["cell Label"])
        self.assertGreater(triangles, 500)
        self.assertEqual(
            sorted(name for name in mesh if " " in name and "offsets" not in name),
            ["cell Component", "cell Label", "point Normals", "point Thickness"],
        )
        self.assertEqual(mesh["points"].dtype, np.float32)
        self.assertEqual(mesh["point Normals"].shape, (points, 3))
        self.assertEqual(mesh["point Thickness"].shape, (points,))
        self.assertEqual(mesh["cell Component"].shape, (triangles,))
        self.assertEqual(mesh["polys"].shape, (3 * triangles,))
        self.assertEqual(len(mesh["lines"]), 0)

    def test_values(self):
        # How far beyond the label's edge a rim may lie.
        for method, overshoot in (("Ridge surface", 0.51), ("Polyline zipper", 0.25)):
            with self.subTest(method):
                self.check_values(self.extract(image(sheets()), Method=method), overshoot)

    def check_values(self, mesh, overshoot):
        # The sheets fill y = 3..6, 12..15 and 21..24: 4 thick, around 4.5, 13.5 and 22.5.
        triangles = mesh["polys"].reshape(-1, 3)
        for label, middle in ((1, 4.5), (2, 13.5), (3, 22.5)):
            corners = np.unique(triangles[mesh["cell Label"] == label])
            self.assertLess(np.abs(mesh["points"][corners, 1] - middle).max(), 0.25)
            self.assertLess(np.abs(np.median(mesh["point Thickness"][corners]) - 4), 0.5)
        self.assertLess(np.abs(np.linalg.norm(mesh["point Normals"], axis=1) - 1).max(), 1e-5)
        self.assertGreater(np.median(np.abs(mesh["point Normals"][:, 1])), 0.99)
        self.assertEqual(set(mesh["cell Component"]), {0, 1, 2})
        for axis, (low, high) in enumerate(((2, 21), (0, 29), (0, 9))):
            self.assertGreaterEqual(mesh["points"][:, axis].min(), low - 0.5 - overshoot)
            self.assertLessEqual(mesh["points"][:, axis].max(), high + 0.5 + overshoot)

    def test_winding_agrees_with_the_normals(self):
        mesh = self.extract(image(tube()))
        corners = mesh["points"][mesh["polys"].reshape(-1, 3)].astype(float)
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = mesh["point Normals"][mesh["polys"].reshape(-1, 3)].mean(axis=1)
        self.assertTrue(((facing * normals).sum(axis=1) > 0).all())

    def test_threads_do_not_matter(self):
        volume = sheets() | np.roll(sheets(), 4, axis=2)
        first = self.extract(image(volume), Threads=1)
        self.assertGreater(len(first["polys"]), 0)
        for threads in (2, 5):
            self.assert_same(first, self.extract(image(volume), Threads=threads))

    def test_scalar_types(self):
        first = self.extract(image(sheets()))
        types = "int8 int16 uint16 int32 uint32 int64 uint64 float32 float64".split()
        for name in types:
            self.assert_same(first, self.extract(image(sheets(dtype=np.dtype(name)))))

    def test_array_names(self):
        first = self.extract(image(sheets()))
        for name in ("outer membrane", "Außenmembran 膜", 'a "quoted" <name>'):
            data = image(sheets(), name)
            add_array(data, sheets() * 0, "another")
            self.assert_same(first, self.extract(data, Segmentation=["POINTS", name]))

    def test_field_data_is_passed_on(self):
        data = image(sheets())
        note = vtkStringArray()
        note.SetName("note")
        note.InsertNextValue("specimen 7")
        data.GetFieldData().AddArray(note)
        polylines = simple.MidPolylines(Input=source(data))
        for proxy in (
            simple.MidSurface(Input=source(data)),
            simple.RidgeField(Input=source(data)),
            polylines,
            simple.PolylineZipper(Input=polylines),
        ):
            output, _ = update(proxy)
            kept = output.GetFieldData().GetAbstractArray("note")
            self.assertEqual(kept.GetValue(0), "specimen 7")


class Stages(FilterTest):
    def test_the_chain_gives_the_same_surface(self):
        for volume in (sheets(), tube(), sheets() | np.roll(sheets(), 4, axis=2)):
            data = image(volume)
            data.SetSpacing(0.7, 0.9, 1.3)
            data.SetOrigin(-11, 5, 3)
            chain = simple.PolylineZipper(Input=simple.MidPolylines(Input=source(data)))
            whole = self.extract(data, Method="Polyline zipper")
            mesh, messages = update(chain)
            self.assertEqual(messages.errors + messages.warnings, [])
            self.assertGreater(mesh.GetNumberOfCells(), 0)
            # The one click's has other triangles.
            distance = vtkImplicitPolyDataDistance()
            distance.SetInput(mesh)
            off = [abs(distance.EvaluateFunction(point)) for point in whole["points"]]
            self.assertLess(max(off), 0.1)
            np.testing.assert_allclose(area(whole), area(arrays(mesh)), rtol=0.02)
            for name in ("cell Label", "cell Component"):
                self.assertEqual(set(whole[name]), set(arrays(mesh)[name]))

    def test_an_edge_length_gives_the_zipper_other_triangles(self):
        data = image(tube())
        whole = self.extract(data, Method="Polyline zipper")
        coarse = self.extract(data, Method="Polyline zipper", EdgeLength=4)
        self.assertLess(2 * len(coarse["cell Label"]), len(whole["cell Label"]))
        self.assertEqual(set(coarse["cell Label"]), {1})
        self.assertEqual(set(coarse["cell Component"]), {0})
        self.assertEqual(len(coarse["point Thickness"]), len(coarse["points"]))

    def test_polylines(self):
        lines, messages = update(simple.MidPolylines(Input=source(image(tube()))))
        self.assertEqual(messages.errors + messages.warnings, [])
        found = arrays(lines)
        self.assertEqual(found["points"].dtype, np.float64)
        self.assertEqual(lines.GetNumberOfCells(), lines.GetNumberOfLines())
        self.assertEqual(sorted(found["cell Slice"]), list(range(12)))
        self.assertEqual(set(found["cell Label"]), {1})
        self.assertEqual(set(found["cell Component"]), {0})
        self.assertEqual(len(found["point Thickness"]), len(found["points"]))
        inside = np.minimum(found["points"], [30, 30, 11] - found["points"])[:, :2].min(axis=1)
        self.assertLess(np.abs(found["point BorderDistance"] - inside).max(), 1e-5)
        steps = lines.GetFieldData().GetArray("VoxelSteps")
        self.assertEqual([steps.GetValue(i) for i in range(9)], [1, 0, 0, 0, 1, 0, 0, 0, 1])
        for first, end in zip(found["lines offsets"], found["lines offsets"][1:]):
            line = found["lines"][first:end]
            self.assertEqual(line[0], line[-1], "a tube is cut in closed lines")
            radius = np.hypot(*(found["points"][line, :2] - 15).T)
            self.assertLess(np.abs(radius - 9).max(), 0.5)

    def test_slices_are_counted_in_the_extent(self):
        data = image(sheets())
        data.SetExtent(0, 23, 0, 29, -4, 5)
        found = arrays(update(simple.MidPolylines(Input=source(data)))[0])
        self.assertEqual(set(found["cell Slice"]), set(range(-4, 6)))

    def test_ridge_field(self):
        data = image(sheets())
        add_array(data, np.arange(sheets().size).reshape(sheets().shape), "kept")
        data.SetSpacing(2, 2, 2)
        field, messages = update(
            simple.RidgeField(Input=source(data), Segmentation=["POINTS", "labels"])
        )
        self.assertEqual(messages.errors + messages.warnings, [])
        self.assertEqual((field.GetDimensions(), field.GetSpacing()), ((24, 30, 10), (2, 2, 2)))
        self.assertEqual(image_array(field, "kept").ravel()[-1], sheets().size - 1)
        distance, ridge = (image_array(field, name) for name in ("Distance", "RidgeField"))
        self.assertEqual((distance.dtype, ridge.dtype), (np.float32, np.float32))
        self.assertTrue((distance[sheets() == 0] == 0).all())
        # Across the sheet the nearest voxel outside is 1, 2, 2, 1 voxels of size 2 away.
        np.testing.assert_allclose(distance[5, 3:7, 12], [2, 4, 4, 2])
        self.assertIn(int(ridge[5, :10, 12].argmax()), (4, 5))

    def test_ridge_field_on_cells(self):
        field, _ = update(
            simple.RidgeField(
                Input=source(image(sheets(), cells=True)), Segmentation=["CELLS", "labels"]
            )
        )
        on_points, _ = update(simple.RidgeField(Input=source(image(sheets()))))
        for name in ("Distance", "RidgeField"):
            self.assertIsNone(field.GetPointData().GetArray(name))
            np.testing.assert_array_equal(
                image_array(field, name, cells=True), image_array(on_points, name)
            )


if __name__ == "__main__":
    run_tests()
