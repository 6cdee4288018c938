"""The judge, gradients, and tests of other renderers."""

import os
import tempfile
import unittest

import numpy

import conic
from conic.testing import PictureMismatch, assert_matches

PROFILE = "gsplat-1.6"


class Judge(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.scene = conic.make("gaussians", n=120, seed=5).gaussians()
        cls.camera = conic.render(cls.scene, size=(40, 30)).camera
        cls.drawn = conic.render(cls.scene, cls.camera, profile=PROFILE, samples=1)

    def test_pictures_of_any_kind(self):
        colors = self.drawn["rgba"][..., :3]
        codes = (numpy.clip(colors, 0, 1) * 255 + 0.5).astype(numpy.uint8)
        for picture in (self.drawn, dict(self.drawn), self.drawn["rgba"], colors, colors[None], codes):
            said = conic.judge(self.scene, self.camera, picture, profile=PROFILE)
            self.assertEqual((said["verdict"], said["pixels"]["wrong"]), ("right", 0))
        with self.assertRaisesRegex(conic.ArgumentError, "shape"):
            conic.judge(self.scene, self.camera, colors[..., 0], profile=PROFILE)
        with self.assertRaisesRegex(conic.InputError, "^picture: it has 40 x 20 pixels"):
            conic.judge(self.scene, self.camera, colors[:20], profile=PROFILE)
        with self.assertRaisesRegex(conic.ArgumentError, "empty"):
            conic.judge(self.scene, self.camera, {}, profile=PROFILE)

    def test_wrong_pixels(self):
        spoiled = self.drawn["rgba"].copy()
        spoiled[10:12, 20:23, :3] += 0.01
        said = conic.judge(self.scene, self.camera, spoiled, profile=PROFILE)
        self.assertEqual((said["verdict"], said["pixels"]["wrong"]), ("wrong", 6))
        said = conic.judge(self.scene, self.camera, spoiled, profile=PROFILE, max_wrong=6)
        self.assertEqual(said["verdict"], "right")

    def test_assertion(self):
        right = assert_matches(self.scene, self.camera, self.drawn["rgba"], profile=PROFILE)
        self.assertEqual(right["verdict"], "right")
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaises(AssertionError) as caught:
                assert_matches(self.scene, self.camera, self.drawn["rgba"][:, ::-1], profile=PROFILE, reports=folder)
            self.assertIsInstance(caught.exception, PictureMismatch)
            self.assertIn("the picture is wrong", str(caught.exception))
            self.assertTrue(caught.exception.files)
            for path in caught.exception.files:
                self.assertIn(path, str(caught.exception))
                self.assertGreater(os.path.getsize(path), 100)

    def test_splats(self):
        scene = conic.make("sphere", n=500).splats()
        camera = conic.Camera.look_at((0, 0, 4), width=40, height=30)
        drawn = conic.render(scene, camera, method="ray", samples=1)
        self.assertEqual(conic.judge(scene, camera, drawn, method="ray")["verdict"], "right")
        self.assertEqual(conic.judge(scene, camera, {"Z": drawn["Z"] * 1.01}, method="ray")["verdict"], "wrong")

    def test_gradient(self):
        weights = numpy.ones((30, 40, 3), numpy.float32)
        found = conic.gradient(self.scene, self.camera, weights, profile=PROFILE)
        self.assertGreater(os.path.getsize(found.path), 120 * 4)
        self.assertEqual(found.statistics["gaussians"], 120)
        found.close()


if __name__ == "__main__":
    unittest.main()
