"""What must not bring it down: too little memory, many runs, two at once, cancels, broken files.

`pvpython test_faults.py PLUGIN FILE.mrc FILE.vti`: the files are whole, and broken here.
"""
import os
import resource
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from paraview import simple

from pipeline import FilterTest, image, run_tests, source, tube, update

METHODS = ("Ridge surface", "Polyline zipper")


def resident():
    """Bytes of memory in use."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def algorithm(method, data):
    """The filter itself, without a proxy."""
    filter_ = simple.MidSurface(Input=source(data), Method=method).GetClientSideObject()
    filter_.Update()
    return filter_


class Repeats(FilterTest):
    """Many runs of one filter leave nothing behind."""

    RUNS = 1000

    def check_growth(self, run):
        for _ in range(self.RUNS // 10):
            run()
        before = resident()
        for _ in range(self.RUNS):
            run()
        self.assertLess(resident() - before, 8e6)

    def test_the_same_filter_again_and_again(self):
        for method in METHODS:
            with self.subTest(method):
                filter_ = algorithm(method, image(tube(depth=6)))
                expected = filter_.GetOutputDataObject(0).GetNumberOfCells()
                self.assertGreater(expected, 0)

                def run():
                    filter_.Modified()
                    filter_.Update()
                    self.assertEqual(filter_.GetOutputDataObject(0).GetNumberOfCells(), expected)

                self.check_growth(run)

    def test_cancelled_at_every_stage(self):
        """Each run is cancelled at the next report of progress, from the first to the last."""
        for method in METHODS:
            with self.subTest(method):
                filter_ = algorithm(method, image(tube(depth=6)))
                reports, stop_at, stages = [0], [-1], set()

                def on_progress(caller, event):
                    reports[0] += 1
                    if reports[0] == stop_at[0]:
                        stages.add(filter_.GetProgressText())
                        filter_.SetAbortExecuteAndUpdateTime()

                filter_.AddObserver("ProgressEvent", on_progress)
                filter_.AddObserver("WarningEvent", lambda caller, event: None)
                filter_.Modified()
                filter_.Update()
                total = reports[0]
                self.assertGreater(total, 5)

                def run():
                    stop_at[0] = stop_at[0] % total + 1
                    reports[0] = 0
                    filter_.SetAbortExecute(0)
                    filter_.Modified()
                    filter_.Update()

                self.check_growth(run)
                self.assertGreater(len(stages), 3, stages)
                stop_at[0] = -1
                filter_.SetAbortExecute(0)
                filter_.Modified()
                filter_.Update()
                self.assertGreater(filter_.GetOutputDataObject(0).GetNumberOfCells(), 0)


LIMITED = """
import resource, sys
sys.path.insert(0, sys.argv[2])
from pipeline import image, np, simple, source, update
simple.LoadPlugin(sys.argv[1], remote=False, ns=vars(simple))
z, y, x = np.mgrid[:96, :96, :96] - 47.5
data = source(image((abs(np.sqrt(x * x + y * y + z * z) - 36) < 3).astype(np.uint8)))
mesh = simple.MidSurface(Input=data, Method=sys.argv[3], Threads=2)
update(simple.MidSurface(Input=source(image(np.ones((4, 4, 4), np.uint8)))))
limit = 1.0
while True:
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    mesh.GetClientSideObject().Modified()
    mesh.MarkModified(mesh)
    resource.setrlimit(resource.RLIMIT_AS, (used + int(limit * 2**20), resource.RLIM_INFINITY))
    output, messages = update(mesh)
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY,) * 2)
    print(f"outcome {limit:.1f} MB: {output.GetNumberOfCells()} triangles,", messages.errors, flush=True)
    if not messages.errors:
        break
    limit *= 1.3
"""


class Memory(FilterTest):
    def test_too_little_memory_is_an_error(self):
        """From a limit of 1 MB more than is in use up to what suffices, by factors of 1.3."""
        # Large buffers always come from the system, not from what malloc keeps of earlier runs,
        # which is in use already and may be enough; nor from arenas that workers hold in advance.
        malloc = {"MALLOC_MMAP_THRESHOLD_": str(2**20), "MALLOC_ARENA_MAX": "1"}
        for method in METHODS:
            with self.subTest(method):
                result = subprocess.run(
                    ["pvpython", "-c", LIMITED, sys.argv[1], str(Path(__file__).parent), method],
                    capture_output=True, text=True, timeout=600, check=False,
                    env=os.environ | malloc,
                )
                outcomes = [line for line in result.stdout.splitlines() if "outcome" in line]
                self.assertEqual(result.returncode, 0, (outcomes, result.stderr[-2000:]))
                self.assertGreater(len(outcomes), 3, outcomes)
                for outcome in outcomes[:-1]:
                    self.assertIn(": 0 triangles", outcome)
                    self.assertRegex(outcome, "memory|threads")
                self.assertNotIn(": 0 triangles", outcomes[-1])


def mrc(content, offset, *values):
    """The file with other 32-bit numbers from `offset` on."""
    kind = "<f" if isinstance(values[0], float) else "<i"
    packed = b"".join(struct.pack(kind, value) for value in values)
    return content[:offset] + packed + content[offset + len(packed) :]


class BrokenFiles(FilterTest):
    """Whatever the reader makes of a broken file, the filter answers: a mesh or a message."""

    def answer(self, content, suffix):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "broken" + suffix)
            Path(path).write_bytes(content)
            reader = (
                simple.MRCSeriesReader(FileNames=[path])
                if suffix == ".mrc"
                else simple.XMLImageDataReader(FileName=[path])
            )
            for method in METHODS:
                mesh, messages = update(simple.MidSurface(Input=reader, Method=method))
                self.assertTrue(
                    mesh.GetNumberOfCells() or messages.errors or messages.warnings, suffix
                )

    def test_mrc(self):
        good = Path(sys.argv[2]).read_bytes()
        for name, content in {
            "only half of the header": good[:512],
            "no voxels": good[:1024],
            "half of the voxels": good[: len(good) // 2],
            "twice as many slices as there are": mrc(good, 8, 64),
            "no slices": mrc(good, 8, 0),
            "an unknown mode": mrc(good, 12, 77),
            "mode of floats": mrc(good, 12, 2),
            "no size": mrc(good, 40, 0.0, 0.0, 0.0),
            "a size that is no number": mrc(good, 40, float("nan"), float("nan"), float("nan")),
            "a negative size": mrc(good, 40, -64.0, -64.0, -32.0),
            "samples of 0": mrc(good, 28, 0, 0, 0),
            "axes in another order": mrc(good, 64, 3, 2, 1),
            "an extended header longer than the file": mrc(good, 92, 2**30),
        }.items():
            with self.subTest(name):
                self.answer(content, ".mrc")

    def test_vti(self):
        good = Path(sys.argv[3]).read_bytes()
        for name, content in {
            "half of the file": good[: len(good) // 2],
            "the first line": good[:60],
            "another array type": good.replace(b"UInt8", b"Float64"),
            "larger than its voxels": good.replace(b"0 63 0 63 0 31", b"0 63 0 63 0 40"),
            "smaller than its voxels": good.replace(b"0 63 0 63 0 31", b"0 63 0 63 0 9"),
            "no spacing": good.replace(b'Spacing="1', b'Spacing="0'),
            "a spacing that is no number": good.replace(b'Spacing="1', b'Spacing="nan'),
            "garbage for voxels": good.replace(b"AAAA", b"!?*_"),
            "voxels of other bytes": good.replace(b"AAAAAA", b"QUJDRE"),
        }.items():
            with self.subTest(name):
                self.assertNotEqual(content, good)
                self.answer(content, ".vti")


if __name__ == "__main__":
    run_tests()
