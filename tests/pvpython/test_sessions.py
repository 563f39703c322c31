"""What ParaView does around a filter: representations, state files, traces, servers, undo."""
import os
import subprocess
import sys
import tempfile

from paraview import servermanager, simple, smtrace
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from pipeline import FilterTest, arrays, image, run_tests, sheets, update


class WithFile(FilterTest):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "sheets.vti")
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(self.path)
        writer.SetInputData(image(sheets()))
        writer.SetDataModeToBinary()
        writer.Write()

    def tearDown(self):
        super().tearDown()
        self.folder.cleanup()


class Sessions(WithFile):
    def pipeline(self):
        reader = simple.XMLImageDataReader(registrationName="volume", FileName=[self.path])
        reader.UpdatePipeline()
        mesh = simple.MidSurface(
            registrationName="mesh", Input=reader, Labels=["1", "3"], EdgeLength=1.7
        )
        simple.MidSurfaceStatistics(registrationName="table", Input=mesh)
        mesh.UpdatePipeline()
        return mesh

    def assert_restored(self, expected):
        mesh = simple.FindSource("mesh")
        self.assertEqual(list(mesh.Labels), ["1", "3"])
        self.assertEqual(mesh.EdgeLength, 1.7)
        self.assertEqual(list(mesh.Segmentation), ["POINTS", "labels"])
        output, messages = update(mesh)
        self.assertEqual(messages.errors + messages.warnings, [])
        self.assert_same(arrays(output), expected)
        self.assertEqual(update(simple.FindSource("table"))[0].GetNumberOfRows(), 5)

    def test_the_mesh_is_shown_as_a_surface_coloured_by_label(self):
        mesh = self.pipeline()
        view = simple.CreateRenderView()
        shown = simple.Show(mesh, view)
        self.assertEqual(shown.Representation, "Surface")
        self.assertEqual(list(shown.ColorArrayName), ["CELLS", "Label"])
        simple.Delete(view)

    def test_the_table_is_for_the_spreadsheet(self):
        proxy = servermanager.ProxyManager().SMProxyManager.GetPrototypeProxy(
            "filters", "MidSurfaceStatistics"
        )
        hint = proxy.GetHints().FindNestedElementByName("View")
        self.assertEqual(hint.GetAttribute("type"), "SpreadSheetView")

    def test_state_files(self):
        for suffix in ("pvsm", "py"):
            expected = arrays(update(self.pipeline())[0])
            state = os.path.join(self.folder.name, "state." + suffix)
            simple.SaveState(state)
            for proxy in list(simple.GetSources().values()):
                simple.Delete(proxy)
            simple.LoadState(state)
            self.assert_restored(expected)
            for proxy in list(simple.GetSources().values()):
                simple.Delete(proxy)

    def test_traces(self):
        smtrace.start_trace()
        expected = arrays(update(self.pipeline())[0])
        trace = smtrace.stop_trace()
        self.assertIn("MidSurface(", trace)
        for proxy in list(simple.GetSources().values()):
            simple.Delete(proxy)
        exec(compile(trace, "trace", "exec"), {})
        self.assert_restored(expected)

    def test_undo_of_a_changed_choice(self):
        """What the Undo button does: the state of a moment ago, loaded into the same proxy."""
        mesh = self.pipeline()
        expected = arrays(update(mesh)[0])
        before = mesh.SMProxy.SaveXMLState(None)
        mesh.Labels = ["2"]
        self.assertEqual(set(arrays(update(mesh)[0])["cell Label"]), {2})
        mesh.SMProxy.LoadXMLState(before, None)
        mesh.SMProxy.UpdateVTKObjects()
        self.assert_same(arrays(update(mesh)[0]), expected)


CLIENT = """
import sys
from paraview import servermanager, simple
simple.Connect("localhost", int(sys.argv[3]))
simple.LoadPlugin(sys.argv[1], remote=False, ns=globals())
simple.LoadPlugin(sys.argv[1], remote=True, ns=globals())
reader = simple.XMLImageDataReader(FileName=[sys.argv[2]])
mesh = MidSurface(Input=reader)
mesh.UpdatePipeline()
mesh.UpdatePipelineInformation()
assert list(mesh.Labels.Available) == ["1", "2", "3"], list(mesh.Labels.Available)
mesh.Labels = ["1", "3"]
mesh.UpdatePipeline()
assert mesh.CellData["Label"].GetRange(0) == (1, 3), mesh.CellData["Label"].GetRange(0)
everything = mesh.GetDataInformation().GetNumberOfCells()
mesh.Labels = ["3"]
mesh.UpdatePipeline()
assert mesh.CellData["Label"].GetRange(0) == (3, 3)
assert 0 < mesh.GetDataInformation().GetNumberOfCells() < everything
table = servermanager.Fetch(MidSurfaceStatistics(Input=mesh))
assert table.GetNumberOfRows() == 3, table.GetNumberOfRows()
print("client and server agree")
"""


class Server(WithFile):
    def serve(self, port):
        """A server that the client's end ends. Returns it once it waits for the client."""
        server = subprocess.Popen(
            ["pvserver", f"--server-port={port}", "--force-offscreen-rendering"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        for line in server.stdout:
            if "Accepting connection" in line:
                return server
        self.fail("pvserver did not start")

    def test_a_client_of_a_server(self):
        port = 20000 + os.getpid() % 20000
        script = os.path.join(self.folder.name, "client.py")
        with open(script, "w") as file:
            file.write(CLIENT)
        server = self.serve(port)
        try:
            client = subprocess.run(
                ["pvpython", script, sys.argv[1], self.path, str(port)],
                capture_output=True,
                text=True,
                timeout=300,
            )
        finally:
            server.terminate()
            server.wait()
            server.stdout.close()
        self.assertIn("client and server agree", client.stdout, client.stderr)


if __name__ == "__main__":
    run_tests()
