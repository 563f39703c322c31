"""Which labels are extracted."""
import numpy as np
from paraview import simple
from paraview.vtk import vtkMultiBlockDataSet
from paraview.vtk.util import numpy_support
from vtkmodules.vtkCommonCore import vtkStringArray

from pipeline import FilterTest, add_array, arrays, image, run_tests, sheets, source, update


def add_names(data, names, values):
    array = vtkStringArray()
    array.SetName("LabelNames")
    for name in names:
        array.InsertNextValue(name)
    data.GetFieldData().AddArray(array)
    if values is not None:
        labels = numpy_support.numpy_to_vtk(values, deep=True)
        labels.SetName("LabelValues")
        data.GetFieldData().AddArray(labels)


def labels_of(proxy):
    mesh, messages = update(proxy)
    return sorted(set(arrays(mesh).get("cell Label", []))), messages


class Labels(FilterTest):
    def test_all_by_default(self):
        self.assertEqual(labels_of(simple.MidSurface(Input=source(image(sheets()))))[0], [1, 2, 3])

    def test_a_choice(self):
        for create in (simple.MidSurface, simple.MidPolylines):
            proxy = create(Input=source(image(sheets())))
            proxy.Labels = ["1", "3"]
            found, messages = labels_of(proxy)
            self.assertEqual(found, [1, 3])
            self.assertEqual(messages.errors + messages.warnings, [])
            self.assertEqual(list(proxy.Labels), ["1", "3"])
            proxy.Labels = ["2"]
            self.assertEqual(labels_of(proxy)[0], [2])

    def test_a_choice_as_an_argument(self):
        proxy = simple.MidSurface(Input=source(image(sheets())), Labels=["1", "3"])
        self.assertEqual(labels_of(proxy)[0], [1, 3])

    def test_a_choice_before_upstream_has_run(self):
        producer = simple.TrivialProducer()
        proxy = simple.MidSurface(Input=producer)
        proxy.Labels = ["1", "3"]
        proxy.Labels = ["3"]
        producer.GetClientSideObject().SetOutput(image(sheets()))
        proxy.Segmentation = ["POINTS", "labels"]
        self.assertEqual(labels_of(proxy)[0], [3])
        proxy.UpdatePipelineInformation()
        self.assertEqual(list(proxy.Labels.Available), ["1", "2", "3"])

    def test_the_ridge_field_keeps_to_the_choice(self):
        proxy = simple.RidgeField(Input=source(image(sheets())), Labels=["2"])
        field, _ = update(proxy)
        distance = np.array(field.GetPointData().GetArray("Distance")).reshape(10, 30, 24)
        self.assertTrue((distance[sheets() == 2] > 0).all())
        self.assertTrue((distance[sheets() != 2] == 0).all())

    def test_a_label_is_extracted_as_if_alone(self):
        volume = np.zeros((10, 20, 24), np.int16)
        volume[:, 4:8, 2:-2] = 1
        volume[:, 8:12, 2:-2] = 2
        both = self.extract(image(volume), Labels=["2"])
        alone = self.extract(image(np.where(volume == 2, volume, np.int16(0))))
        self.assert_same(both, alone)

    def test_sparse_labels(self):
        found, messages = labels_of(
            simple.MidSurface(Input=source(image(sheets(labels=(200,)))))
        )
        self.assertEqual(found, [200])
        self.assertEqual(messages.errors + messages.warnings, [])

    def test_negative_and_large_labels(self):
        labels = (-7, 2**40)
        volume = image(sheets(dtype=np.int64, labels=labels))
        proxy = simple.MidSurface(Input=source(volume))
        self.assertEqual(list(proxy.Labels), ["-7", str(2**40)])
        self.assertEqual(labels_of(proxy)[0], list(labels))

    def test_a_missing_label_is_an_error(self):
        for asked in (["9"], ["1", "9"], ["one"]):
            proxy = simple.MidSurface(Input=source(image(sheets())), Labels=asked)
            mesh, messages = update(proxy)
            self.assert_empty(mesh)
            self.assertEqual(len(messages.errors), 1, asked)
            self.assertIn(asked[-1], messages.errors[0])
            self.assertIn("1, 2, 3", messages.errors[0])
            proxy.Labels = ["1"]
            self.assertEqual(labels_of(proxy)[0], [1])

    def test_nothing_ticked(self):
        proxy = simple.MidSurface(Input=source(image(sheets())))
        proxy.Labels = []
        mesh, messages = update(proxy)
        self.assert_empty(mesh)
        self.assertEqual((len(messages.errors), len(messages.warnings)), (0, 1))
        self.assertIn("no label", messages.warnings[0])

    def test_labels_of_any_kind(self):
        """Sparse, negative and large values, as floats too, on points and on cells."""
        for dtype, labels in (
            (np.uint16, (1, 200, 40000)),
            (np.int32, (-40000, -1, 5)),
            (np.float32, (-3, 2, 40000)),
            (np.float64, (1, 2**40, 2**53)),
            (np.int64, (-(2**60), 7, 2**60 + 1)),
        ):
            for cells in (False, True):
                proxy = simple.MidSurface(
                    Input=source(image(sheets(dtype=dtype, labels=labels), "меm brane", cells))
                )
                self.assertEqual(list(proxy.Labels), [str(label) for label in labels])
                found, messages = labels_of(proxy)
                self.assertEqual(found, list(labels))
                self.assertEqual(messages.errors + messages.warnings, [])
                proxy.Labels = [str(labels[2])]
                self.assertEqual(labels_of(proxy)[0], [labels[2]])


class Names(FilterTest):
    """Field data can name the labels."""

    names = ("outer membrane", "Außenmembran 膜: 2", "ER")
    listed = ["1: outer membrane", "2: Außenmembran 膜: 2", "3: ER"]

    def named(self, names=("background", *names), values=None, labels=(1, 2, 3)):
        data = image(sheets(labels=labels, dtype=np.int64))
        add_names(data, names, values)
        return data

    def test_entry_i_names_label_i(self):
        proxy = simple.MidSurface(Input=source(self.named()))
        self.assertEqual(list(proxy.Labels), self.listed)
        found, messages = labels_of(proxy)
        self.assertEqual(found, [1, 2, 3])
        self.assertEqual(messages.errors + messages.warnings, [])

    def test_values_tell_which_labels_are_named(self):
        for values, dtype in (((2**60, -7, 55), np.int64), ((40000, -7, 55), np.float32)):
            data = self.named(self.names, np.array(values, dtype), (-7, values[0], 200))
            proxy = simple.MidSurface(Input=source(data))
            listed = ["-7: Außenmembran 膜: 2", "200", f"{values[0]}: outer membrane"]
            self.assertEqual(sorted(proxy.Labels), sorted(listed))

    def test_a_label_is_chosen_by_number_name_or_both(self):
        proxy = simple.MidSurface(Input=source(self.named()))
        for chosen, expected in (
            (["2"], [2]),
            (["ER"], [3]),
            (["3: ER"], [3]),
            (["Außenmembran 膜: 2", "1"], [1, 2]),
            (["1", "2", "3"], [1, 2, 3]),
            (["3: a former name"], [3]),
        ):
            proxy.Labels = chosen
            found, messages = labels_of(proxy)
            self.assertEqual(found, expected, chosen)
            self.assertEqual(messages.errors + messages.warnings, [])

    def test_a_missing_name_is_an_error_that_lists_the_names(self):
        proxy = simple.MidSurface(Input=source(self.named()), Labels=["inner membrane"])
        mesh, messages = update(proxy)
        self.assert_empty(mesh)
        self.assertIn("inner membrane", messages.errors[0])
        self.assertIn(", ".join(self.listed), messages.errors[0])

    def test_names_that_do_not_fit_are_left_alone(self):
        for names, values in (
            (("background",), None),
            (self.names, np.array([1, 2])),
            (self.names, np.array([1.5, np.nan, 7])),
        ):
            proxy = simple.MidSurface(Input=source(self.named(names, values)))
            self.assertEqual(list(proxy.Labels), ["1", "2", "3"])
            self.assertEqual(labels_of(proxy)[0], [1, 2, 3])

    def test_names_of_a_collection(self):
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, self.named(("", "first")))
        blocks.SetBlock(1, image(sheets(labels=(1, 4))))
        add_names(blocks, ("", "all", "", "", "fourth"), None)
        proxy = simple.MidSurface(Input=source(blocks))
        self.assertEqual(list(proxy.Labels), ["1: first", "2", "3", "4: fourth"])

    def test_names_are_passed_on(self):
        mesh, _ = update(simple.MidSurface(Input=source(self.named())))
        kept = mesh.GetFieldData().GetAbstractArray("LabelNames")
        self.assertEqual(kept.GetValue(3), "ER")


class ChangingInput(FilterTest):
    """All ticked means all, whatever the input becomes; a choice stays a choice."""

    def two_arrays(self):
        data = image(sheets(labels=(1, 2)), "first")
        add_array(data, sheets(labels=(1, 2, 5)), "second")
        return source(data)

    def test_all_ticked_stays_all(self):
        proxy = simple.MidSurface(Input=self.two_arrays(), Segmentation=["POINTS", "first"])
        self.assertEqual(labels_of(proxy)[0], [1, 2])
        proxy.Segmentation = ["POINTS", "second"]
        found, messages = labels_of(proxy)
        self.assertEqual(found, [1, 2, 5])
        self.assertEqual(messages.errors + messages.warnings, [])
        proxy.UpdatePipelineInformation()
        self.assertEqual(list(proxy.Labels.Available), ["1", "2", "5"])

    def test_all_ticked_stays_all_without_a_run_between(self):
        proxy = simple.MidSurface(Input=self.two_arrays(), Segmentation=["POINTS", "first"])
        proxy.Segmentation = ["POINTS", "second"]
        self.assertEqual(labels_of(proxy)[0], [1, 2, 5])

    def test_a_choice_stays(self):
        proxy = simple.MidSurface(Input=self.two_arrays(), Segmentation=["POINTS", "first"])
        proxy.Labels = ["1"]
        self.assertEqual(labels_of(proxy)[0], [1])
        proxy.Segmentation = ["POINTS", "second"]
        self.assertEqual(labels_of(proxy)[0], [1])

    def test_a_choice_for_the_new_array_is_no_all(self):
        proxy = simple.MidSurface(Input=self.two_arrays(), Segmentation=["POINTS", "first"])
        update(proxy)
        proxy.Segmentation = ["POINTS", "second"]
        proxy.Labels = ["1", "2"]
        self.assertEqual(labels_of(proxy)[0], [1, 2])

    def test_a_chosen_label_that_vanished_is_an_error(self):
        proxy = simple.MidSurface(Input=self.two_arrays(), Segmentation=["POINTS", "second"])
        proxy.Labels = ["5"]
        self.assertEqual(labels_of(proxy)[0], [5])
        proxy.Segmentation = ["POINTS", "first"]
        mesh, messages = update(proxy)
        self.assert_empty(mesh)
        self.assertIn("5", messages.errors[0])

    def test_new_data_is_read_anew(self):
        producer = source(image(sheets(labels=(1, 2))))
        proxy = simple.MidSurface(Input=producer)
        self.assertEqual(labels_of(proxy)[0], [1, 2])
        producer.GetClientSideObject().SetOutput(image(sheets(labels=(4, 6, 8))))
        producer.MarkModified(producer.SMProxy)
        self.assertEqual(labels_of(proxy)[0], [4, 6, 8])


if __name__ == "__main__":
    run_tests()
