"""Where the mesh lies: cells, extents, spacing, origin, direction, units."""
import numpy as np
from paraview import simple

from pipeline import FilterTest, arrays, image, run_tests, sheets, source, tube, update


class Frames(FilterTest):
    def assert_moved(self, mesh, reference, move):
        """The same triangles, with `move` applied to the points."""
        np.testing.assert_array_equal(mesh["polys"], reference["polys"])
        expected = move(reference["points"].astype(float))
        np.testing.assert_allclose(mesh["points"], expected, rtol=1e-5, atol=1e-4)

    def test_cells_lie_on_their_centres(self):
        reference = self.extract(image(tube()))
        data = image(tube(), cells=True)
        mesh = self.extract(data, Segmentation=["CELLS", "labels"])
        self.assert_moved(mesh, reference, lambda points: points + 0.5)

    def test_cells_are_found_by_default(self):
        proxy = simple.MidSurface(Input=source(image(sheets(), cells=True)))
        self.assertEqual(list(proxy.Segmentation), ["CELLS", "labels"])

    def test_cells_with_spacing_and_direction(self):
        on_points, on_cells = image(tube()), image(tube(), cells=True)
        for data in (on_points, on_cells):
            data.SetSpacing(0.5, 0.75, 2)
            data.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
        reference = self.extract(on_points)
        mesh = self.extract(on_cells, Segmentation=["CELLS", "labels"])
        # Half a spacing along each of the image's axes; its y axis is the world's -x.
        self.assert_moved(mesh, reference, lambda points: points + [-0.375, 0.25, 1.0])

    def test_extent_and_origin(self):
        reference = self.extract(image(tube()))
        data = image(tube())
        data.SetOrigin(100, -50, 7)
        data.SetExtent(*(n + offset for n, offset in zip(data.GetExtent(), (3, 3, -8, -8, 20, 20))))
        self.assert_moved(self.extract(data), reference, lambda p: p + [103, -58, 27])

    def test_spacing(self):
        data = image(tube())
        data.SetSpacing(1, 1, 2.5)
        points = self.extract(data)["points"]
        self.assertLess(np.abs(np.hypot(*(points[:, :2] - 15).T) - 9).max(), 0.5)
        self.assertAlmostEqual(points[:, 2].max(), 27.5, delta=1.3)

    def test_direction(self):
        turned = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0], [0.48, 0.64, 0.6]])
        reference = self.extract(image(tube()))
        data = image(tube())
        data.SetDirectionMatrix(*turned.ravel())
        self.assert_moved(self.extract(data), reference, lambda p: p @ turned.T)

    def test_units(self):
        for scale in (10.0, 1e-3):
            meshes = []
            for factor in (1.0, scale):
                data = image(tube())
                data.SetSpacing(*(factor * s for s in (1.1, 1.3, 1.7)))
                data.SetOrigin(*(factor * o for o in (20.0, -3.0, 8.0)))
                meshes.append(self.extract(data))
            first, scaled = meshes
            np.testing.assert_array_equal(first["polys"], scaled["polys"])
            for name in ("points", "point Thickness"):
                size = np.abs(scaled[name]).max()
                np.testing.assert_allclose(
                    scaled[name], scale * first[name], rtol=1e-5, atol=1e-5 * size
                )
            np.testing.assert_allclose(
                scaled["point Normals"], first["point Normals"], rtol=0, atol=1e-4
            )


class ThinImages(FilterTest):
    """One voxel along an axis: whatever comes out, there is a message or a mesh, and no crash."""

    def run_all(self, data, segmentation):
        polylines = simple.MidPolylines(Input=source(data), Segmentation=segmentation)
        for proxy in (
            simple.MidSurface(Input=source(data), Segmentation=segmentation),
            simple.RidgeField(Input=source(data), Segmentation=segmentation),
            polylines,
        ):
            yield update(proxy)
        lines, _ = update(polylines)
        if lines.GetNumberOfLines():
            yield update(simple.PolylineZipper(Input=polylines))

    def test_one_voxel_along_each_axis(self):
        for shape in ((1, 30, 24), (10, 1, 24), (10, 30, 1), (1, 1, 24), (1, 1, 1)):
            volume = np.ones(shape, np.uint8)
            volume[..., : shape[2] // 3] = 0
            for output, messages in self.run_all(image(volume), ["POINTS", "labels"]):
                self.assertTrue(
                    output.GetNumberOfCells() or messages.warnings or messages.errors, shape
                )

    def test_one_layer_of_cells(self):
        for points in ((25, 31, 1), (25, 1, 11), (1, 31, 11), (1, 1, 11), (1, 1, 1)):
            shape = tuple(max(n - 1, 1) for n in reversed(points))
            data = image(np.ones(shape, np.uint8), cells=True)
            data.SetDimensions(*points)
            for output, messages in self.run_all(data, ["CELLS", "labels"]):
                self.assertEqual([m for m in messages.errors if "array holds" in m], [])
                self.assertTrue(
                    output.GetNumberOfCells() or messages.warnings or messages.errors, points
                )

    def test_a_single_slice_has_polylines(self):
        lines, _ = update(simple.MidPolylines(Input=source(image(tube(depth=1)))))
        self.assertEqual(list(arrays(lines)["cell Slice"]), [0])
        mesh, messages = update(
            simple.MidSurface(Input=source(image(tube(depth=1))), Method="Polyline zipper")
        )
        self.assert_empty(mesh)
        self.assertEqual((len(messages.errors), len(messages.warnings)), (0, 1))


if __name__ == "__main__":
    run_tests()
