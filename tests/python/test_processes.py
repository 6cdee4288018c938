"""What Python processes of their own do: calls within calls, Ctrl-C, an example, the plugin for pytest."""

import importlib.util
import os
import signal
import subprocess
import sys
import tempfile
import textwrap
import unittest

import conic
from drawn_by_program import hashes

NESTED = """
import conic
scene = conic.make("sphere", n=500)
splats = scene.splats()
wanted = {}
for what in (scene, splats):
    wanted[id(what)] = conic.render(what, size=(32, 24)).hash()
depth = [0]
found = []
def tell(task, done):
    if depth[0] < 2 and len(found) < 8:
        depth[0] += 1
        for what in (scene, splats):
            found.append(conic.render(what, size=(32, 24), progress=tell).hash() == wanted[id(what)])
        conic.release()
        depth[0] -= 1
for what in (scene, splats):
    found.clear()
    assert conic.render(what, size=(32, 24), progress=tell).hash() == wanted[id(what)]
    assert len(found) >= 4 and all(found), found
print("all drawn")
"""

# A thread's picture waits, in what it has called, for one that another draws of the same scene.
BESIDE = """
import conic, threading
scene = conic.make("sphere", n=500)
wanted = conic.render(scene, size=(32, 24)).hash()
found = []
def draw():
    found.append(conic.render(scene, size=(32, 24)).hash() == wanted)
def tell(task, done):
    if not found:
        other = threading.Thread(target=draw)
        other.start()
        other.join()
conic.render(scene, size=(32, 24), progress=tell)
assert found == [True], found
scene.close()
print("all drawn")
"""

# Signals itself, and says how long its processors worked until the call came back: what else the machine does hardly
# counts.
INTERRUPTED = """
import conic, os, signal, sys, threading, time
work = {work!r}
scene = conic.open({path!r})
at = []
def shoot():
    time.sleep({wait})
    at.append(time.process_time())
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=shoot, daemon=True).start()
try:
    while True:
        if work == "draw":
            conic.render(scene, size=(3000, 3000), accumulate=1000)
        elif work == "light":
            conic.render(scene, size=(900, 900), ao=65536)
        elif work == "read":
            conic.render(conic.open({path!r}), size=(16, 16), as_="points")
        else:
            conic.render(conic.Splats(scene.splats().position), size=(16, 16))
except KeyboardInterrupt:
    print("interrupted", time.process_time() - at[0])
"""

# Ctrl-C comes while what a scene has kept is given back.
FORGETTING = """
import conic, os, signal, time
from conic._library import Kept
destroy = Kept._destroy
def interrupted(kept):
    os.kill(os.getpid(), signal.SIGINT)
    destroy(kept)
scene = conic.open({path!r})
conic.render(scene, size=(16, 16))
Kept._destroy = interrupted
try:
    del scene
    time.sleep(30)
except KeyboardInterrupt:
    Kept._destroy = destroy
    print("interrupted")
"""

# Ctrl-C ends the main thread, and with it what others draw.
OTHERS = """
import conic, os, signal, threading, time
scene = conic.make("sphere", n=2000)
def draw():
    try:
        conic.render(scene, size=(3000, 3000), accumulate=100000)
    except conic.Cancelled:
        os.write(1, b"cancelled")
thread = threading.Thread(target=draw)
thread.start()
time.sleep(1)
threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
{wait}
"""


def run(program, seconds=60):
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=seconds, check=False)


class Processes(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.scene = conic.make("knot", cls.path("knot.ply"), n=3000)

    @classmethod
    def tearDownClass(cls):
        cls.scene.close()
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def test_calls_within_calls(self):
        for program in (NESTED, BESIDE):
            done = run(program)
            self.assertEqual((done.stdout, done.stderr), ("all drawn\n", ""))

    def test_interrupts(self):
        splats = conic.make("sphere", self.path("large.ply"), n=400000)
        for work, wait in (("draw", 1.0), ("light", 1.0), ("read", 0.7), ("estimate", 1.5)):
            with self.subTest(work=work):
                done = run(INTERRUPTED.format(work=work, path=splats.path, wait=wait))
                self.assertEqual(done.stdout.split()[:1], ["interrupted"], done.stderr)
                self.assertLess(float(done.stdout.split()[1]), 0.6)
        for wait in ("time.sleep(60)", "thread.join()"):
            with self.subTest(wait=wait):
                done = run(OTHERS.format(wait=wait))
                self.assertEqual(done.returncode, -signal.SIGINT, done.stderr)
                self.assertIn("KeyboardInterrupt", done.stderr)
                if "join" not in wait:  # whose end Python 3.11 takes for the thread's
                    self.assertEqual(done.stdout, "cancelled")

    def test_an_interrupt_of_forgetting(self):
        done = run(FORGETTING.format(path=self.scene.path), 25)
        self.assertEqual((done.stdout, done.stderr), ("interrupted\n", ""))

    def test_example(self):
        example = os.path.join(os.path.dirname(__file__), "../../python/examples/final_picture.py")
        done = subprocess.run([sys.executable, example, self.scene.path, self.folder.name], capture_output=True,
                              text=True, check=True)
        wanted = hashes(self.scene.path, "--size", "200x200", "--projection", "fisheye", "--fov", "150", "--ao", "8",
                        "--shadow", "--accumulate", "8")
        self.assertEqual(done.stdout.strip(), wanted["rgba"])
        conic.render(self.scene, size=(1200, 900), samples=1, output=self.path("whole.exr"))
        with open(self.path("strips.exr"), "rb") as strips, open(self.path("whole.exr"), "rb") as whole:
            self.assertEqual(strips.read(), whole.read())
        with self.assertRaisesRegex(conic.ArgumentError, "in_memory"):
            conic.render(self.scene, in_memory=False)

    @unittest.skipUnless(importlib.util.find_spec("pytest"), "pytest (python3-pytest) is not there")
    def test_plugin(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "test_wrong.py"), "w", encoding="utf-8") as file:
                file.write(textwrap.dedent("""\
                    import conic
                    from conic.testing import assert_matches

                    def test_picture():
                        scene = conic.make("gaussians", n=50).gaussians()
                        camera = conic.render(scene, size=(20, 20)).camera
                        drawn = conic.render(scene, camera, profile="exact", samples=1)
                        assert_matches(scene, camera, drawn["rgba"] * 0.9, profile="exact")
                    """))
            done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p",
                                   "conic.pytest_plugin", "--conic-reports", "kept", "test_wrong.py"], cwd=folder,
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertIn("- conic -", done.stdout)
            kept = os.path.join(folder, "kept", "test_wrong.py_test_picture")
            self.assertIn("map.png", os.listdir(kept))


if __name__ == "__main__":
    unittest.main()
