"""Maps of any values, of which everything at or above a threshold is label 1."""
import numpy as np
from paraview import simple

from pipeline import FilterTest, arrays, image, run_tests, source, tube, update


class Threshold(FilterTest):
    def probabilities(self, dtype=np.float32):
        noise = np.random.default_rng(3).random(tube().shape)
        return np.where(tube() == 1, 0.7 + 0.3 * noise, 0.69 * noise).astype(dtype)

    def test_a_probability_map(self):
        expected = self.extract(image(tube()))
        for dtype in (np.float32, np.float64):
            for cells in (False, True):
                data = image(self.probabilities(dtype), cells=cells)
                found = self.extract(data, UseThreshold=1, Threshold=0.7)
                np.testing.assert_array_equal(found["polys"], expected["polys"])
                self.assertEqual(set(found["cell Label"]), {1})

    def test_whole_numbers(self):
        grey = (200 * self.probabilities()).astype(np.int16) - 100
        expected = self.extract(image(tube()))
        found = self.extract(image(grey), UseThreshold=1, Threshold=39.5)
        self.assert_same(found, expected)

    def test_the_label_list_has_one_label(self):
        proxy = simple.MidSurface(
            Input=source(image(self.probabilities())), UseThreshold=1, Threshold=0.7
        )
        update(proxy)
        proxy.UpdatePipelineInformation()
        self.assertEqual(list(proxy.Labels.Available), ["1"])

    def test_the_threshold_can_be_moved(self):
        proxy = simple.MidSurface(Input=source(image(self.probabilities())), UseThreshold=1)
        proxy.Threshold = 2.0
        mesh, messages = update(proxy)
        self.assert_empty(mesh)
        self.assertEqual((messages.errors, len(messages.warnings)), ([], 1))
        proxy.Threshold = 0.7
        mesh, messages = update(proxy)
        self.assertEqual(messages.errors + messages.warnings, [])
        self.assertGreater(mesh.GetNumberOfCells(), 0)

    def test_off_by_default(self):
        proxy = simple.MidSurface(Input=source(image(self.probabilities())))
        mesh, messages = update(proxy)
        self.assertEqual((proxy.UseThreshold, proxy.Threshold), (0, 0.5))
        self.assert_empty(mesh)
        self.assertIn("use a threshold", messages.errors[0])

    def test_no_number_is_background(self):
        volume = self.probabilities()
        volume[tube() == 0] = np.nan
        found = self.extract(image(volume), UseThreshold=1, Threshold=-5)
        self.assert_same(found, self.extract(image(tube())))


if __name__ == "__main__":
    run_tests()
