"""MRC files through ParaView's own reader: `pvpython test_mrc.py PLUGIN FILE.mrc`.

FILE.mrc is a tube along z, 64 x 64 x 32 voxels.
"""
import lzma
import os
import struct
import sys
import tempfile
from pathlib import Path

import numpy as np
from paraview import simple

from pipeline import DATA, FilterTest, arrays, image, run_tests, source, tube, update

SLICES = 32


class Files(FilterTest):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.good = Path(sys.argv[2]).read_bytes()

    def tearDown(self):
        super().tearDown()
        self.folder.cleanup()

    def reader(self, content):
        path = os.path.join(self.folder.name, "volume.mrc")
        Path(path).write_bytes(content)
        reader = simple.MRCSeriesReader(FileNames=[path])
        reader.UpdatePipeline()
        return reader

    def header(self, spacing, slices):
        """The file with voxels of this size and `slices` for the number of slices (mz)."""
        x, y, z = spacing
        content = bytearray(self.good)
        content[36:40] = struct.pack("<i", slices)
        content[40:52] = struct.pack("<3f", 64 * x, 64 * y, SLICES * z)
        return bytes(content)


class Spacing(Files):
    def run_filter(self, content, **properties):
        proxy = simple.MidSurface(Input=self.reader(content), **properties)
        mesh, messages = update(proxy)
        self.assertEqual(messages.errors, [])
        return arrays(mesh), messages.warnings

    def test_a_stretched_z_is_corrected_with_a_warning(self):
        broken = self.header((12.44, 12.44, 12.44), 1)
        spacing = update(self.reader(broken))[0].GetSpacing()
        self.assertAlmostEqual(spacing[2], SLICES * 12.44, delta=0.01)
        expected, quiet = self.run_filter(self.header((12.44, 12.44, 12.44), SLICES))
        self.assertEqual(quiet, [])
        found, warnings = self.run_filter(broken)
        np.testing.assert_allclose(found["points"], expected["points"], rtol=1e-5, atol=1e-3)
        np.testing.assert_array_equal(found["polys"], expected["polys"])
        self.assertEqual(len(warnings), 1)
        for word in ("398.08", "12.44", "still drawn stretched", "1 1 0.03125", "As given"):
            self.assertIn(word, warnings[0])

    def test_as_given_believes_the_file(self):
        reader = self.reader(self.header((2, 2, 2), 1))
        polylines = simple.MidPolylines(Input=reader, Spacing="As given")
        lines, messages = update(polylines)
        self.assertEqual(messages.errors + messages.warnings, [])
        self.assertEqual(lines.GetBounds()[5], (SLICES - 1) * SLICES * 2)
        polylines.Spacing = "Automatic"
        lines, messages = update(polylines)
        self.assertEqual(len(messages.warnings), 1)
        self.assertEqual(lines.GetBounds()[5], (SLICES - 1) * 2)

    def test_spacing_1_passes_silently(self):
        for spacing in ((1, 1, 1), (1, 1, 4), (13.3, 13.3, 13.3)):
            _, warnings = self.run_filter(self.header(spacing, SLICES))
            self.assertEqual(warnings, [], spacing)

    def test_the_stages_are_corrected_too(self):
        reader = self.reader(self.header((3, 3, 3), 1))
        ridge, _ = update(simple.MidSurface(Input=reader, Method="Ridge surface"))
        whole, _ = update(simple.MidSurface(Input=reader, Method="Polyline zipper"))
        # Half a voxel of 3 between the methods.
        np.testing.assert_allclose(ridge.GetBounds(), whole.GetBounds(), atol=1.5)
        polylines = simple.MidPolylines(Input=reader)
        _, messages = update(polylines)
        self.assertEqual(len(messages.warnings), 1)
        mesh, _ = update(simple.PolylineZipper(Input=polylines))
        # A tenth of a voxel of 3: the whole is remeshed.
        np.testing.assert_allclose(whole.GetBounds(), mesh.GetBounds(), atol=0.3)
        field = simple.RidgeField(Input=reader)
        output, messages = update(field)
        self.assertEqual(len(messages.warnings), 1)
        self.assertEqual(output.GetSpacing(), (3, 3, 3))
        # Upstream of another image filter, too.
        cells = simple.PointDatatoCellData(Input=field)
        self.assertEqual(update(cells)[0].GetSpacing(), (3, 3, 3))
        self.assertLessEqual(output.GetPointData().GetArray("Distance").GetRange()[1], 30)

    def test_a_piece_is_judged_by_the_whole(self):
        """Half of the slices are 32 times as high as wide, but there are no 32 of them."""
        reader = self.reader(self.header((3, 3, 3), 1))
        half = simple.ExtractSubset(Input=reader, VOI=[0, 63, 0, 63, 0, 15])
        mesh, messages = update(simple.MidSurface(Input=half))
        self.assertNotIn("stretched", "".join(messages.warnings))

    def test_cells(self):
        data = image(tube(depth=SLICES - 1), cells=True)
        data.SetSpacing(3, 3, 3 * SLICES)
        mesh, messages = update(simple.MidSurface(Input=source(data)))
        self.assertEqual(len(messages.warnings), 1)
        self.assertAlmostEqual(mesh.GetBounds()[4], 1.5, delta=0.5)
        self.assertAlmostEqual(mesh.GetBounds()[5], 3 * (SLICES - 1) - 1.5, delta=0.5)


class RealFile(Files):
    def test_the_mesh_is_that_from_the_image_file(self):
        packed = DATA / "Fig11-OMM.mrc.xz"
        if not packed.exists():
            self.skipTest(f"{packed} is not there")
        mrc = self.reader(lzma.decompress(packed.read_bytes()))
        mesh, messages = update(simple.MidSurface(Input=mrc))
        self.assertEqual(messages.errors, [])
        image_file = simple.XMLImageDataReader(FileName=[str(DATA / "Fig11-OMM.vti")])
        same, _ = update(simple.MidSurface(Input=image_file))
        # The file's spacing is 1.244 to seven digits along each axis, not exactly isotropic.
        spacing = update(mrc)[0].GetSpacing()
        np.testing.assert_allclose(spacing, 1.244, rtol=1e-3)
        triangles = same.GetNumberOfCells()
        self.assertGreater(triangles, 100000)
        self.assertAlmostEqual(mesh.GetNumberOfCells(), triangles, delta=1e-3 * triangles)
        np.testing.assert_allclose(
            mesh.GetBounds(), np.array(same.GetBounds()) * np.repeat(spacing, 2), atol=0.01
        )


if __name__ == "__main__":
    run_tests()
