"""Names, defaults and places of the filters in ParaView."""
import os
import tempfile

from paraview import servermanager, simple

from pipeline import FilterTest, add_array, arrays, image, run_tests, sheets, source, update


class Properties(FilterTest):
    def test_mid_surface_has_its_properties(self):
        proxy = simple.MidSurface(Input=source(image(sheets())))
        self.assertEqual(list(proxy.Segmentation), ["POINTS", "labels"])
        self.assertEqual(list(proxy.Labels), ["1", "2", "3"])
        self.assertEqual(proxy.Method, "Ridge surface")
        self.assertEqual(proxy.Threads, 0)
        self.assertEqual(proxy.EdgeLength, 0)
        self.assertEqual(proxy.Spacing, "Automatic")
        self.assertEqual(
            list(proxy.GetProperty("Method").GetAvailable()), ["Ridge surface", "Polyline zipper"]
        )

    def test_stages_have_theirs(self):
        for create in (simple.RidgeField, simple.MidPolylines):
            proxy = create(Input=source(image(sheets())))
            self.assertEqual(list(proxy.Segmentation), ["POINTS", "labels"])
            self.assertEqual(list(proxy.Labels), ["1", "2", "3"])
            self.assertEqual(proxy.Threads, 0)
            self.assertNotIn("Method", proxy.ListProperties())
        zipper = simple.PolylineZipper(Input=simple.MidPolylines(Input=source(image(sheets()))))
        self.assertEqual(zipper.Threads, 0)

    def test_the_array_is_one_of_the_input_whatever_is_active(self):
        """pvpython shows a new filter the active source before the Input that it is given."""
        data = image(sheets(), "first")
        add_array(data, sheets(), "second")
        first = source(data)
        mesh = simple.MidSurface(Input=first)
        mesh.UpdatePipeline()
        for create in (simple.MidSurface, simple.RidgeField, simple.MidPolylines):
            simple.SetActiveSource(mesh)
            self.assertEqual(list(create(Input=first).Segmentation), ["POINTS", "first"])
            simple.SetActiveSource(mesh)
            proxy = create(Input=first, Segmentation=["POINTS", "second"])
            self.assertEqual(list(proxy.Segmentation), ["POINTS", "second"])

    def test_the_array_of_an_input_that_has_not_run_yet(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sheets.vti")
            simple.SaveData(path, source(image(sheets())), DataMode="Binary")
            mesh, messages = update(
                simple.MidSurface(Input=simple.XMLImageDataReader(FileName=[path]))
            )
            self.assertEqual(messages.errors + messages.warnings, [])
            self.assertEqual(set(arrays(mesh)["cell Label"]), {1, 2, 3})

    def test_menu_and_help(self):
        manager = servermanager.ProxyManager().SMProxyManager
        for name, category in (
            ("MidSurface", "Mid-Surface"),
            ("RidgeField", "Mid-Surface Stages"),
            ("MidPolylines", "Mid-Surface Stages"),
            ("PolylineZipper", "Mid-Surface Stages"),
        ):
            prototype = manager.GetPrototypeProxy("filters", name)
            hint = prototype.GetHints().FindNestedElementByName("ShowInMenu")
            self.assertEqual(hint.GetAttribute("category"), category)
            self.assertTrue(hint.GetAttribute("icon"))
            help_text = prototype.GetDocumentation()
            self.assertTrue(help_text.GetShortHelp() and help_text.GetLongHelp())
            self.assertGreater(len(help_text.GetDescription()), 200)

    def test_what_few_need_is_advanced(self):
        proxy = simple.MidSurface(Input=source(image(sheets())))
        for name, visibility in (
            ("Threads", "advanced"),
            ("EdgeLength", "advanced"),
            ("Spacing", "advanced"),
            ("Method", "default"),
        ):
            self.assertEqual(
                proxy.SMProxy.GetProperty(name).GetPanelVisibility(), visibility, name
            )

    def test_negative_threads_mean_all(self):
        quiet = arrays(update(simple.MidSurface(Input=source(image(sheets())), Threads=-3))[0])
        self.assertGreater(len(quiet["polys"]), 0)

    def test_unknown_method_is_an_error(self):
        proxy = simple.MidSurface(Input=source(image(sheets())))
        proxy.SMProxy.GetProperty("Method").SetElement(0, 77)
        proxy.SMProxy.UpdateVTKObjects()
        mesh, messages = update(proxy)
        self.assert_empty(mesh)
        self.assertEqual(len(messages.errors), 1)

    def test_a_negative_edge_length_is_an_error(self):
        proxy = simple.MidSurface(Input=source(image(sheets())), EdgeLength=-2)
        mesh, messages = update(proxy)
        self.assert_empty(mesh)
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("edge length -2", messages.errors[0])


if __name__ == "__main__":
    run_tests()
