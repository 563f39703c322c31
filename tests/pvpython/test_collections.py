"""Collections of images, with empty blocks, and series of time steps."""
import os
import tempfile

from paraview import servermanager, simple
from paraview.vtk import vtkImageData, vtkMultiBlockDataSet
from vtkmodules.vtkCommonDataModel import vtkPartitionedDataSetCollection
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from pipeline import FilterTest, Messages, arrays, image, run_tests, sheets, source


def update(proxy):
    """Runs a filter. Returns its output, which ParaView 5.11 cannot fetch, and its messages."""
    messages = Messages(proxy)
    proxy.UpdatePipeline()
    proxy.UpdatePipeline()
    return proxy.GetClientSideObject().GetOutputDataObject(0), messages


def partitioned(images):
    result = vtkPartitionedDataSetCollection()
    for index, data in enumerate(images):
        result.SetPartition(index, 0, data)
    return result


def multi_block(images):
    result = vtkMultiBlockDataSet()
    for index, data in enumerate(images):
        result.SetBlock(index, data)
    return result


def leaves(data):
    """The data sets of a collection, in their order."""
    iterator = data.NewIterator()
    iterator.InitTraversal()
    found = []
    while not iterator.IsDoneWithTraversal():
        found.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return found


class Collections(FilterTest):
    makers = (multi_block, partitioned)

    def labels_of(self, data):
        return [set(arrays(leaf).get("cell Label", [])) for leaf in leaves(data)]

    def test_every_block_has_its_mesh(self):
        for make in self.makers:
            proxy = simple.MidSurface(
                Input=source(make([image(sheets(labels=(1, 2))), image(sheets(labels=(2, 7)))]))
            )
            self.assertEqual(list(proxy.Labels), ["1", "2", "7"])
            output, messages = update(proxy)
            self.assertEqual(messages.errors + messages.warnings, [])
            self.assertEqual(self.labels_of(output), [{1, 2}, {2, 7}])
            proxy.Labels = ["7"]
            output, messages = update(proxy)
            self.assertEqual(messages.errors + messages.warnings, [])
            self.assertEqual(self.labels_of(output), [set(), {7}])

    def test_empty_blocks_are_passed_over(self):
        empty = vtkImageData()
        for make in self.makers:
            for blocks in ([image(sheets()), empty], [empty, image(sheets())]):
                proxy = simple.MidSurface(Input=source(make(blocks)), Segmentation="labels")
                output, messages = update(proxy)
                self.assertEqual(messages.errors + messages.warnings, [])
                self.assertEqual(set.union(*self.labels_of(output)), {1, 2, 3})

    def test_blocks_without_a_label_are_silent_beside_others(self):
        for make in self.makers:
            blocks = [image(sheets() * 0), image(sheets())]
            output, messages = update(simple.MidSurface(Input=source(make(blocks))))
            self.assertEqual(messages.errors + messages.warnings, [])
            self.assertEqual(self.labels_of(output)[-1], {1, 2, 3})
            blocks = [image(sheets() * 0), image(sheets() * 0)]
            output, messages = update(simple.MidSurface(Input=source(make(blocks))))
            self.assertTrue(messages.warnings)

    def test_blocks_with_frames_of_their_own(self):
        turned = image(sheets())
        turned.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
        shifted = image(sheets())
        shifted.SetExtent(5, 28, -3, 26, 7, 16)
        shifted.SetOrigin(0, 0, 100)
        alone = [arrays(update(simple.MidSurface(Input=source(d)))[0]) for d in (turned, shifted)]
        for make in self.makers:
            output, _ = update(simple.MidSurface(Input=source(make([turned, shifted]))))
            for leaf, expected in zip(leaves(output), alone):
                self.assert_same(arrays(leaf), expected)

    def test_the_stages_too(self):
        for make in self.makers:
            data = source(make([image(sheets()), image(sheets(labels=(4,)))]))
            lines = simple.MidPolylines(Input=data)
            mesh, messages = update(simple.PolylineZipper(Input=lines))
            self.assertEqual(messages.errors + messages.warnings, [])
            self.assertEqual(self.labels_of(mesh), [{1, 2, 3}, {4}])
            field, messages = update(simple.RidgeField(Input=data))
            self.assertEqual(messages.errors + messages.warnings, [])
            for leaf in leaves(field):
                self.assertGreater(leaf.GetPointData().GetArray("RidgeField").GetRange()[1], 0)


class TimeSteps(FilterTest):
    def test_labels_and_meshes_follow_the_time(self):
        with tempfile.TemporaryDirectory() as folder:
            names = []
            for step, labels in enumerate(((1, 2), (2, 5), (9,))):
                names.append(os.path.join(folder, f"step{step}.vti"))
                writer = vtkXMLImageDataWriter()
                writer.SetFileName(names[-1])
                writer.SetInputData(image(sheets(labels=labels)))
                writer.SetDataModeToBinary()
                writer.Write()
            reader = simple.XMLImageDataReader(FileName=names)
            proxy = simple.MidSurface(Input=reader)
            for step, labels in ((0, {1, 2}), (1, {2, 5}), (2, {9}), (0, {1, 2})):
                proxy.UpdatePipeline(reader.TimestepValues[step])
                mesh = servermanager.Fetch(proxy)
                self.assertEqual(set(arrays(mesh)["cell Label"]), labels)
                proxy.UpdatePipelineInformation()
                self.assertEqual(list(proxy.Labels.Available), [str(n) for n in sorted(labels)])


if __name__ == "__main__":
    run_tests()
