"""Failures, progress, Ctrl-C, threads, and memory."""

import copy
import gc
import os
import pickle
import resource
import signal
import tempfile
import threading
import unittest
import warnings
import weakref

import numpy

import conic
from conic._shelf import Shelf

SIZE = (64, 48)


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


class Runs(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.scene = conic.make("sphere", n=2000)
        cls.splats = cls.scene.splats()
        cls.wanted = dict(conic.render(cls.scene, size=SIZE).statistics["hash"].items())

    @classmethod
    def tearDownClass(cls):
        cls.scene.close()

    def test_failures(self):
        for kind, call in ((conic.InputError, lambda: conic.open("nothing.ply")),
                           (conic.InputError, lambda: conic.render("nothing.ply")),
                           (conic.ArgumentError, lambda: conic.render(self.scene, size=(0, 10))),
                           (conic.ArgumentError, lambda: conic.render(3)),
                           (conic.ArgumentError, lambda: conic.command("nonsense")),
                           (conic.UnsupportedError, lambda: conic.render(self.scene, device="opencl:99.99")),
                           (conic.InputError, lambda: conic.Camera.from_file("nothing.json")),
                           (conic.OutputError, lambda: conic.render(self.scene, size=SIZE, output="/nowhere/out.exr"))):
            with self.assertRaises(conic.Error) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))
            self.assertIsInstance(caught.exception, kind)
        with self.assertRaisesRegex(conic.InputError, r"nothing\.ply: cannot read"):
            conic.render("nothing.ply")
        self.assertEqual(conic.render(self.splats, size=SIZE).statistics["hash"], self.wanted)

    def test_warnings(self):
        away = conic.Camera.look_at((0, 0, 5), (0, 0, 9), width=8, height=8)
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always")
            conic.render(self.splats, away)
        self.assertEqual([(w.category, os.path.basename(w.filename)) for w in heard],
                         [(conic.ConicWarning, "test_runs.py")])
        self.assertIn("the picture is empty", str(heard[0].message))

    def test_progress(self):
        told = []
        conic.render(self.scene, size=SIZE, progress=lambda task, done: told.append((task, done)))
        self.assertTrue(told and all(0 <= done <= 1 for _, done in told))
        with self.assertRaises(conic.Cancelled):
            conic.render(self.scene, size=SIZE, progress=lambda task, done: True)

        def fail(task, done):
            raise ZeroDivisionError(task)

        with self.assertRaises(ZeroDivisionError):
            conic.render(self.scene, size=SIZE, progress=fail)

        class Bar:  # as tqdm's
            total, n = None, 0.0

            def update(self, more):
                self.n += more

        bar = Bar()
        conic.render(self.scene, size=SIZE, progress=bar)
        self.assertEqual(bar.total, 1.0)
        self.assertGreater(bar.n, 0.0)

    def test_interrupt(self):
        before = signal.getsignal(signal.SIGINT)
        with self.assertRaises(KeyboardInterrupt):
            conic.render(self.scene, size=SIZE, progress=lambda *_: os.kill(os.getpid(), signal.SIGINT))
        self.assertIs(signal.getsignal(signal.SIGINT), before)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "out.cot")
            with self.assertRaises(KeyboardInterrupt):
                conic.octree(self.splats, path, progress=lambda *_: os.kill(os.getpid(), signal.SIGINT))
            self.assertEqual(os.listdir(folder), [])
        self.assertEqual(conic.render(self.splats, size=SIZE).statistics["hash"], self.wanted)

    def test_threads(self):
        found, failed = [], []

        def draw(i):
            try:
                scene = self.scene if i % 2 else self.splats
                for _ in range(3):
                    found.append(conic.render(scene, size=SIZE, threads=1 + i % 3).statistics["hash"]["rgba"])
                try:
                    conic.render(f"nothing{i}.ply")
                except conic.InputError as failure:
                    failed.append(str(failure).startswith(f"nothing{i}.ply"))
            except BaseException as failure:  # pylint: disable=broad-except
                failed.append(failure)

        threads = [threading.Thread(target=draw, args=(i,)) for i in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(set(found), {self.wanted["rgba"]})
        self.assertEqual(failed, [True] * 6)

    def test_fork(self):
        conic.render(self.splats, size=SIZE)
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            signal.alarm(30)
            drawn = conic.render(self.splats, size=SIZE).statistics["hash"]["rgba"]
            os.write(writer, drawn.encode())
            os._exit(0)
        os.close(writer)
        with os.fdopen(reader) as file:
            self.assertEqual(file.read(), self.wanted["rgba"])
        os.waitpid(child, 0)

    def test_memory_stays(self):
        calls = int(os.environ.get("CONIC_CALLS", "60"))

        def work():
            conic.render(self.splats, size=SIZE, method="conic", samples=1)
            conic.render(self.scene, size=SIZE, method="conic", samples=1, output=None, azimuth=calls)
            try:
                conic.render(self.splats, size=SIZE, tile=5)
            except conic.ArgumentError:
                pass

        for _ in range(20):
            work()
        gc.collect()
        before = resident_bytes()
        for _ in range(calls):
            work()
        gc.collect()
        grown = resident_bytes() - before
        self.assertLess(grown, 4 << 20, f"{calls} rounds of calls keep {grown} bytes")

    def test_array_is_the_callers(self):
        splats = self.splats.position.copy()
        picture = conic.render(conic.Splats(splats, self.splats.tangent_u, self.splats.tangent_v), size=SIZE)
        held = picture["rgba"].copy()
        del splats
        conic.release()
        conic.render(self.splats, size=SIZE)
        self.assertTrue(numpy.array_equal(picture["rgba"], held))

    def test_pictures_are_pickled(self):
        picture = conic.render(self.splats, size=SIZE)
        for again in (pickle.loads(pickle.dumps(picture)), copy.deepcopy(picture)):
            self.assertEqual(again.statistics["hash"], self.wanted)
            self.assertEqual((again.hash(), again.camera, again.is_display),
                             (self.wanted["rgba"], picture.camera, picture.is_display))
            self.assertFalse(numpy.shares_memory(again["rgba"], picture["rgba"]))

    def test_shelf(self):
        shelf = Shelf()
        array = shelf.take("Z", (4, 6), "float32")
        array[...] = 7.0
        del array
        part = shelf.take("Z", (4, 6), "float32")[1:]
        self.assertTrue((part == 7.0).all())  # the same memory
        held = memoryview(shelf.take("Z", (4, 6), "float32"))
        for _ in range(3):
            other = shelf.take("Z", (4, 6), "float32")
            self.assertFalse(numpy.shares_memory(other, part) or numpy.shares_memory(other, held))
        self.assertEqual(shelf.take("Z", (2, 2), "uint32").dtype, numpy.uint32)

    def test_nothing_shows_of_earlier_pictures(self):
        options = {"size": (97, 61), "planes": "all"}
        gaussians = conic.make("gaussians", n=200)
        for scene in (self.splats, self.scene, gaussians):
            for samples in (1, 2):
                conic.release()
                first = conic.render(scene, samples=samples, **options)
                wanted, held = dict(first.statistics["hash"].items()), first["Z"][3]
                row = held.copy()
                for name in first.planes:
                    if name != "Z":
                        first[name].view(numpy.uint8)[...] = 0xA5  # must not show in a later picture
                del first
                for _ in range(3):
                    again = conic.render(scene, samples=samples, **options)
                    self.assertEqual(dict(again.statistics["hash"].items()), wanted)
                self.assertTrue(numpy.array_equal(held, row))

    def test_pictures_go_at_once(self):
        gc.disable()
        self.addCleanup(gc.enable)
        picture = conic.render(self.splats, size=SIZE)
        gone, hashes = weakref.ref(picture), picture.statistics["hash"]
        del picture
        self.assertIsNone(gone())
        self.assertEqual(hashes, self.wanted)


if __name__ == "__main__":
    unittest.main()
