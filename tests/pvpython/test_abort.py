"""Progress, and what is left of a run that was aborted."""
from paraview import simple

from pipeline import FilterTest, image, run_tests, sheets, source, update


class Progress(FilterTest):
    def proxies(self):
        data = source(image(sheets()))
        polylines = simple.MidPolylines(Input=data)
        zipper = simple.PolylineZipper(Input=polylines)
        polylines.UpdatePipeline()
        return (
            simple.MidSurface(Input=data),
            simple.RidgeField(Input=data),
            simple.MidPolylines(Input=data),
            zipper,
        )

    def test_progress_rises_and_names_its_stages(self):
        for proxy in self.proxies():
            algorithm = proxy.GetClientSideObject()
            seen = []

            def note(caller, event):
                seen.append((caller.GetProgress(), caller.GetProgressText()))

            algorithm.AddObserver("ProgressEvent", note)
            proxy.UpdatePipeline()
            fractions = [fraction for fraction, _ in seen]
            self.assertEqual(fractions, sorted(fractions))
            self.assertGreaterEqual(fractions[0], 0)
            self.assertLessEqual(fractions[-1], 1)
            self.assertTrue(any(text for _, text in seen))

    def test_abort(self):
        for proxy in self.proxies():
            algorithm = proxy.GetClientSideObject()
            tag = algorithm.AddObserver(
                "ProgressEvent", lambda caller, event: caller.SetAbortExecuteAndUpdateTime()
            )
            output, messages = update(proxy)
            self.assert_empty(output)
            self.assertEqual(messages.errors, [])
            self.assertEqual(len(messages.warnings), 1)
            self.assertIn("cancelled", messages.warnings[0])

            algorithm.RemoveObserver(tag)
            algorithm.SetAbortExecute(False)
            algorithm.Modified()
            output, messages = update(proxy)
            self.assertGreater(output.GetNumberOfCells(), 0)
            self.assertGreater(output.GetAttributes(0).GetNumberOfArrays(), 0)
            self.assertEqual(messages.errors + messages.warnings, [])


if __name__ == "__main__":
    run_tests()
