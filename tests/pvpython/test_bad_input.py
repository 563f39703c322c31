"""Bad input: a message that a user can act on, an empty output, never a crash."""
import numpy as np
from paraview import simple
from paraview.vtk import vtkImageData, vtkPolyData
from vtkmodules.vtkCommonCore import vtkBitArray, vtkStringArray

from pipeline import FilterTest, add_array, arrays, image, run_tests, sheets, source, update


class BadVolumes(FilterTest):
    filters = ("MidSurface", "RidgeField", "MidPolylines")

    def assert_error(self, data, segmentation, *words):
        for name in self.filters:
            proxy = getattr(simple, name)(Input=source(data))
            proxy.Segmentation = segmentation
            output, messages = update(proxy)
            self.assert_empty(output)
            self.assertEqual(len(messages.errors), 1, (name, messages.errors))
            for word in words:
                self.assertIn(word, messages.errors[0])

    def assert_warning(self, data, word):
        for name in self.filters:
            output, messages = update(getattr(simple, name)(Input=source(data)))
            self.assertEqual(messages.errors, [])
            self.assertEqual(len(messages.warnings), 1, (name, messages.warnings))
            self.assertIn(word, messages.warnings[0])
            if name != "RidgeField":
                self.assert_empty(output)

    def test_no_array(self):
        data = vtkImageData()
        data.SetDimensions(5, 6, 7)
        self.assert_error(data, ["POINTS", ""], "no arrays")
        self.assert_error(data, ["POINTS", "missing"], "missing", "Segmentation")

    def test_another_array(self):
        self.assert_error(image(sheets()), ["POINTS", "missing"], "missing", '"labels"')

    def test_labels_that_are_averaged(self):
        # Asked for points' labels on cells, ParaView averages them before the filter sees them.
        self.assert_error(image(sheets()), ["CELLS", "labels"], "whole numbers")

    def test_vectors(self):
        data = image(np.repeat(sheets()[..., None], 3, axis=3))
        self.assert_error(data, ["POINTS", "labels"], "3 components")

    def test_text(self):
        data = image(sheets())
        names = vtkStringArray()
        names.SetName("names")
        names.SetNumberOfValues(sheets().size)
        data.GetPointData().AddArray(names)
        self.assert_error(data, ["POINTS", "names"], "names", "no numbers")

    def test_no_label(self):
        self.assert_warning(image(sheets() * 0), "label")

    def test_no_voxel(self):
        self.assert_warning(vtkImageData(), "no voxels")

    def test_nan(self):
        volume = sheets(dtype=np.float32)
        volume[4, 5, 6] = np.nan
        self.assert_error(image(volume), ["POINTS", "labels"], "NaN")

    def test_fractions(self):
        self.assert_error(
            image(sheets(dtype=np.float64) * 0.5), ["POINTS", "labels"], "0.5", "whole numbers"
        )

    def test_raw_tomogram(self):
        volume = np.random.default_rng(1).integers(0, 60000, (10, 20, 30)).astype(np.uint16)
        self.assert_error(image(volume), ["POINTS", "labels"], "tomogram")

    def test_spacing(self):
        for spacing in ((0, 1, 1), (1, -1, 1), (1, 1, float("nan"))):
            data = image(sheets())
            data.SetSpacing(*spacing)
            self.assert_error(data, ["POINTS", "labels"], "spacing")

    def test_labels_that_are_too_large(self):
        volume = sheets(dtype=np.uint64)
        volume[4, 5, 6] = 2**64 - 1
        self.assert_error(image(volume), ["POINTS", "labels"], str(2**64 - 1), "too large")

    def test_noise_is_noise_wherever_it_is(self):
        noise = np.random.default_rng(2).integers(0, 250, (40, 20, 30)).astype(np.uint8)
        for raw in (slice(0, 18), slice(22, 40)):
            volume = np.zeros_like(noise)
            volume[raw] = noise[raw]
            self.assert_error(image(volume), ["POINTS", "labels"], "tomogram")
        # Few voxels of many values are nothing unusual.
        volume = np.zeros_like(noise)
        volume[0, 0] = noise[0, 0]
        volume[:, 8:12, 4:-4] = 251
        volume[0, 1, ::3] = np.arange(100, 110)
        mesh, messages = update(simple.MidSurface(Input=source(image(volume)), Labels=["251"]))
        self.assertEqual(messages.errors, [])
        self.assertGreater(mesh.GetNumberOfCells(), 0)

    def test_array_that_is_too_short(self):
        data = image(sheets())
        data.GetPointData().GetArray("labels").SetNumberOfTuples(100)
        self.assert_error(data, ["POINTS", "labels"], "100")

    def test_all_voxels_labelled(self):
        for name in self.filters:
            output, messages = update(
                getattr(simple, name)(Input=source(image(np.ones((6, 7, 8), np.uint8))))
            )
            self.assertTrue(messages.errors or messages.warnings or output.GetNumberOfCells())

    def test_bits_are_labels(self):
        data = image(sheets(labels=(1,)))
        bits = vtkBitArray()
        bits.SetName("bits")
        bits.DeepCopy(data.GetPointData().GetArray("labels"))
        bits.SetName("bits")
        data.GetPointData().AddArray(bits)
        found = self.extract(data, Segmentation=["POINTS", "bits"])
        self.assert_same(found, self.extract(data, Segmentation=["POINTS", "labels"]))

    def test_good_input_after_bad(self):
        data = image(sheets())
        add_array(data, sheets(dtype=np.float32) * 0.5, "bad")
        proxy = simple.MidSurface(Input=source(data))
        proxy.Segmentation = ["POINTS", "bad"]
        mesh, messages = update(proxy)
        self.assert_empty(mesh)
        self.assertEqual(len(messages.errors), 1)
        proxy.Segmentation = ["POINTS", "labels"]
        self.assertEqual(set(arrays(update(proxy)[0])["cell Label"]), {1, 2, 3})


class BadPolylines(FilterTest):
    def good(self):
        lines, _ = update(simple.MidPolylines(Input=source(image(sheets()))))
        copy = vtkPolyData()
        copy.DeepCopy(lines)
        return copy

    def assert_error(self, data, word):
        mesh, messages = update(simple.PolylineZipper(Input=source(data)))
        self.assert_empty(mesh)
        self.assertEqual(len(messages.errors), 1)
        self.assertIn(word, messages.errors[0])

    def test_no_lines(self):
        self.assert_error(vtkPolyData(), "no lines")

    def test_lines_that_are_not_in_slices(self):
        lines = self.good()
        lines.GetCellData().RemoveArray("Slice")
        self.assert_error(lines, "Slice")

    def test_points_that_are_no_numbers(self):
        lines = self.good()
        lines.GetPoints().SetPoint(3, float("nan"), 0, 0)
        self.assert_error(lines, "")

    def test_points_that_are_not_there(self):
        lines = self.good()
        lines.GetLines().GetConnectivityArray().SetComponent(5, 0, 10**7)
        self.assert_error(lines, "")

    def test_arrays_of_other_types(self):
        lines = self.good()
        expected, _ = update(simple.PolylineZipper(Input=source(lines)))
        other = self.good()
        for name in ("Slice", "Label", "Component"):
            values = np.array(other.GetCellData().GetArray(name)).astype(np.int32)
            other.GetCellData().RemoveArray(name)
            add_array(other, values, name, cells=True)
        other.GetLines().ConvertTo32BitStorage()
        found, messages = update(simple.PolylineZipper(Input=source(other)))
        self.assertEqual(messages.errors + messages.warnings, [])
        self.assert_same(arrays(expected), arrays(found))


if __name__ == "__main__":
    run_tests()
