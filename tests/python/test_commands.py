"""Every kind of source from files, and the commands besides render."""

import json
import os
import tempfile
import unittest

import numpy

import conic
from drawn_by_program import conic as program
from drawn_by_program import hashes

SIZE = (80, 60)
WORDS = ("--size", "80x60")


class Commands(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.splats = conic.make("torus", cls.path("torus.ply"), n=4000)
        cls.gaussians = conic.make("gaussians", cls.path("gaussians.ply"), n=300)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def assert_drawn_alike(self, scene, *words, **options):
        wanted = hashes(*scene.paths, *WORDS, *words)
        for _ in range(2):  # read, and kept
            self.assertEqual(conic.render(scene, size=SIZE, **options).statistics["hash"], wanted)

    def test_every_kind(self):
        with open(self.path("points.xyz"), "w", encoding="utf-8") as file:
            for x, y, z in self.splats.splats().position[::4]:
                file.write(f"{x} {y} {z}\n")
        with open(self.path("square.obj"), "w", encoding="utf-8") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0\nf 1 2 3 4\n")
        kinds = [self.splats, conic.open(self.path("points.xyz")), conic.open(self.path("square.obj")), self.gaussians,
                 conic.octree(self.splats, self.path("torus.cot")), conic.hybrid(self.path("square.obj"),
                                                                                  self.path("square.chy")),
                 conic.convert(self.gaussians, self.path("gaussians.splat")),
                 conic.csg(self.splats, conic.make("sphere", n=500, far=(1, 0, 0)), self.path("solid.ply"), difference=True)]
        if conic.features()["zstd"]:
            kinds.append(conic.layers(self.splats, self.path("torus.lpc")))
            kinds.append(conic.convert(self.gaussians, self.path("gaussians.spz")))
        for scene in kinds:
            with self.subTest(path=scene.path):
                self.assert_drawn_alike(scene)
        self.assert_drawn_alike(kinds[1], "-k", "12", k=12)
        self.assert_drawn_alike(conic.open(self.path("torus.cot")), "--error", "2", error=2)
        self.assert_drawn_alike(conic.open(self.path("torus.ply"), self.path("square.obj")))

    def test_options(self):
        for words, options in ((("--method", "patch"), {"method": "patch"}),
                               (("--light", "1,2,3", "--light", "head:1,0,0"), {"light": [(1, 2, 3), "head:1,0,0"]}),
                               (("--epsilon", "2x", "--samples", "3"), {"epsilon": "2x", "samples": 3}),
                               (("--background", "0.1,0.2,0.3"), {"background": (0.1, 0.2, 0.3)}),
                               (("--exposure", "auto"), {"exposure": "auto"}), (("--plain",), {"plain": True}),
                               (("--elevation", "-20"), {"elevation": -20}),
                               (("--color-by", "height"), {"color_by": "height"})):
            with self.subTest(words=words):
                self.assert_drawn_alike(self.splats, *words, **options)
        picture = conic.render(self.splats, size=SIZE, planes=["N", "id", "P"])
        self.assertEqual(picture.planes, ["N", "id", "P"])
        self.assertEqual(picture["N"].shape, (60, 80, 3))
        self.assertEqual(picture["id"].dtype, numpy.uint32)
        for wanted, options in (("did you mean method\\?", {"methd": "ray"}), ("size=\\(64,\\) is not", {"size": (64,)}),
                                ("it takes \\(W, H\\)", {"size": "x"}), ("as_='msh' is not", {"as_": "msh"})):
            with self.assertRaisesRegex(conic.ArgumentError, wanted):
                conic.render(self.splats, **options)
        for words in ({"json": "x"}, {"output": "-"}):
            with self.assertRaises(conic.ArgumentError):
                conic.render(self.splats, **words)

    def test_turntable(self):
        pictures = conic.turntable(self.splats, 3, size=SIZE)
        self.assertEqual([picture["rgba"].shape for picture in pictures], 3 * [(60, 80, 4)])
        self.assertNotEqual(pictures[0].statistics["hash"], pictures[1].statistics["hash"])

    def test_arguments_that_have_no_end(self):
        endless = []
        endless.append(endless)
        scene = self.path("torus.ply")
        for call in (lambda: conic.render(endless), lambda: conic.render(scene, light=endless),
                     lambda: conic.render("a\0" + scene), lambda: conic.render(scene, kernel="hat\0x"),
                     lambda: conic.Camera.from_file("a\0b"), lambda: conic.info("a\0b")):
            with self.assertRaises(conic.ArgumentError):
                call()

    def test_cameras(self):
        drawn = conic.render(self.splats, size=SIZE)
        camera = conic.Camera.from_K(drawn.camera.viewmat[None], drawn.camera.K[None], *SIZE)
        self.assertEqual(camera, drawn.camera)
        camera.save(self.path("camera.json"))
        self.assertEqual(conic.Camera.from_file(self.path("camera.json")), camera)
        wanted = hashes(self.splats.path, "--camera", self.path("camera.json"))
        for given in (camera, self.path("camera.json")):
            self.assertEqual(conic.render(self.splats, given).statistics["hash"], wanted)
        self.assertEqual(conic.render(self.splats, camera, size=(40, 30)).statistics["hash"],
                         conic.render(self.splats, camera.resized(40, 30)).statistics["hash"])
        eye = conic.Camera.look_at((0, 0, 5), fov=60, width=30, height=20)
        self.assertTrue(numpy.allclose(eye.position, [0, 0, 5]))
        self.assertTrue(numpy.allclose(eye.viewmat @ [0, 0, 0, 1], [0, 0, 5, 1]))
        self.assertTrue(numpy.allclose(eye.viewmat @ [1, 2, 0, 1], [1, -2, 5, 1]))
        self.assertAlmostEqual(eye.K[0, 0], 10 / numpy.tan(numpy.radians(30)))
        with self.assertRaises(conic.ArgumentError):
            conic.Camera.look_at((0, 0, 0))

    def test_colmap(self):
        os.makedirs(self.path("model/sparse/0"), exist_ok=True)
        with open(self.path("model/sparse/0/cameras.txt"), "w", encoding="utf-8") as file:
            file.write("1 PINHOLE 80 60 90 91 40 30\n")
        with open(self.path("model/sparse/0/images.txt"), "w", encoding="utf-8") as file:
            file.write("1 1 0 0 0 0 0 4 1 b.jpg\n\n2 1 0 0 0 0 0 5 1 a.jpg\n\n")
        camera = conic.Camera.from_colmap(self.path("model"), "a.jpg")
        self.assertEqual((camera.name, camera.viewmat[2, 3], camera.K[1, 1]), ("a.jpg", 5.0, 91.0))
        self.assertEqual(conic.Camera.from_colmap(self.path("model"), 1).viewmat[2, 3], 4.0)
        self.assertEqual(len(conic.list_cameras(self.path("model"))), 2)
        with self.assertRaisesRegex(conic.ArgumentError, "2 views"):
            conic.Camera.from_colmap(self.path("model"))
        views = conic.render(self.splats, self.path("model"), view="all")
        self.assertEqual([view.camera.name for view in views], ["a.jpg", "b.jpg"])
        self.assertEqual(views[0].statistics["hash"],
                         hashes(self.splats.path, "--camera", self.path("model"), "--view", "a.jpg"))
        self.assertEqual(len(conic.render(self.splats, size=SIZE, turntable=3)), 3)

    def test_pictures(self):
        picture = conic.render(self.splats, size=SIZE)
        picture.save(self.path("saved.exr"))
        conic.render(self.splats, size=SIZE, output=[self.path("written.exr"), self.path("written.png")])
        self.assertTrue(conic.diff(self.path("saved.exr"), self.path("written.exr"))["identical"])
        self.assertTrue(conic.diff(picture, self.path("saved.exr"))["identical"])
        for options in ({}, {"tone": "srgb"}, {"tone": "filmic"}):
            picture.save(self.path("saved.png"), **options)
            conic.render(self.splats, size=SIZE, output=self.path("toned.png"), background="none", **options)
            self.assertTrue(conic.diff(self.path("saved.png"), self.path("toned.png"))["identical"])
        self.assertFalse(conic.diff(picture, self.path("toned.png"))["max_abs"] < 0.01)
        with self.assertRaisesRegex(conic.ArgumentError, "tone: none is none of srgb, filmic, aces"):
            picture.save(self.path("saved.png"), tone="none")
        codes = picture.to_uint8()
        self.assertEqual((codes.shape, codes.dtype), ((60, 80, 3), numpy.uint8))
        self.assertLess(conic.diff(codes, self.path("written.png"))["max_abs"], 0.01)
        self.assertEqual(picture._repr_png_()[:8], b"\x89PNG\r\n\x1a\n")
        told = json.loads(json.dumps(picture.statistics))
        self.assertEqual(told["hash"], picture.statistics["hash"])
        self.assertIn("rgba", picture.statistics["hash"])
        other = conic.render(self.splats, size=SIZE, method="point")
        said = conic.diff(picture["rgba"], other)
        self.assertFalse(said["identical"])
        self.assertGreater(said["psnr"], 5)

    def test_questions(self):
        drawn = conic.render(self.splats, conic.Camera.look_at((1, 2, 3), width=40, height=30))
        self.assertTrue(conic.verify(self.splats, drawn.camera, pixels=50)["pass"])
        self.assertTrue(conic.verify(self.splats.splats(), drawn.camera, image=drawn, samples=2, pixels=50)["pass"])
        spoiled = conic.Picture({"rgba": drawn["rgba"] * 0.9}, camera=drawn.camera)
        self.assertFalse(conic.verify(self.splats, drawn.camera, image=spoiled, samples=2)["pass"])
        said = conic.explain(self.splats, drawn.camera, (20, 15))
        self.assertEqual(said["pixel"], [20, 15])
        self.assertEqual(conic.info(self.splats.path)["points"], 4000)
        self.assertTrue(self.splats.info(check=True)["sound"])
        self.assertEqual(self.splats.info(), program("info", self.splats.path))
        self.assertIn("devices", json.dumps(conic.devices()))

    def test_builders(self):
        places = self.splats.splats().position
        prepared = conic.prepare(conic.Splats(places), count=1000)
        self.assertEqual(prepared.statistics["points_out"], 1000)
        self.assertEqual(len(prepared.splats()), 1000)
        folder = os.path.dirname(prepared.path)
        prepared.close()
        self.assertFalse(os.path.exists(folder))
        thinned = conic.mls("thin", self.splats, self.path("thin.ply"), count=500)
        self.assertEqual(len(thinned.splats()), 500)
        self.assertEqual(len(conic.convert(self.gaussians.gaussians(), self.path("again.ply")).gaussians()), 300)
        with self.assertRaises(conic.InputError):
            conic.octree(self.path("nothing.ply"))


if __name__ == "__main__":
    unittest.main()
