"""Real segmentations, where there are any: MIDSURFACE_DATA, or ../shared/data beside the sources."""
import numpy as np
from paraview import simple

from pipeline import DATA, FilterTest, arrays, run_tests, update


class RealData(FilterTest):
    def mesh(self, name):
        path = DATA / name
        if not path.exists():
            self.skipTest(f"{path} is not there")
        reader = simple.XMLImageDataReader(FileName=[str(path)])
        reader.UpdatePipeline()
        output, messages = update(simple.MidSurface(Input=reader))
        self.assertEqual(messages.errors, [])
        return arrays(output)

    def check(self, name):
        mesh = self.mesh(name)
        triangles = mesh["polys"].reshape(-1, 3)
        self.assertGreater(len(triangles), 1000)
        self.assertEqual(len(np.unique(triangles)), len(mesh["points"]), "unused points")
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        directed = np.unique(edges, axis=0)
        self.assertEqual(len(directed), len(edges), "an edge run through twice in one direction")
        _, uses = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
        self.assertLessEqual(uses.max(), 2, "an edge with more than two triangles")
        for values in mesh.values():
            self.assertTrue(np.isfinite(values).all())

    def test_fig7(self):
        self.check("Fig7.vti")

    def test_fig11_imm(self):
        self.check("Fig11-IMM.vti")

    def test_fig11_omm(self):
        self.check("Fig11-OMM.vti")

    def test_fig13a(self):
        self.check("Fig13A.vti")

    def test_fig13b(self):
        self.check("Fig13B.vti")


if __name__ == "__main__":
    run_tests()
