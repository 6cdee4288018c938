"""The judge, gradients, and tests of other renderers."""

import os
import tempfile
import unittest

import numpy

import conic
from conic.testing import PictureMismatch, assert_intermediates, assert_matches

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

    def test_intermediates(self):
        made = conic.project(self.scene, self.camera, profile=PROFILE)
        given = {name: made[name] for name in ("radii", "means2d", "conics", "depths", "opacities", "colors",
                                               "tiles_per_gauss", "isect_ids", "flatten_ids", "isect_offsets")}
        given = {name: array.astype(numpy.float32) if array.dtype == float else array for name, array in given.items()}
        colors, alphas = self.drawn["rgba"][..., :3], self.drawn["rgba"][..., 3:]

        def judged(**changed):
            return assert_intermediates({**given, **changed}, self.scene, self.camera, profile=PROFILE,
                                        render_colors=colors, render_alphas=alphas)

        said = judged()
        self.assertEqual([array["judged"] for array in said["arrays"]],
                         [120] * 4 + [len(made["isect_ids"])] * 2 + [120, 6, 120, 120, 1200, 1200])
        judged(**{name: given[name][None] for name in ("means2d", "radii", "opacities")}, width=40, gaussian_ids=None)
        shown = numpy.nonzero(made["radii"][:, 0] > 0)[0]
        row = numpy.full(120, -1)
        row[shown] = numpy.arange(len(shown))
        packed = {name: array[shown] for name, array in given.items() if len(array) == 120}
        packed.update(gaussian_ids=shown, flatten_ids=row[made["flatten_ids"]])
        judged(**packed)

        largest = made["radii"].max(1).argmax()
        swapped = numpy.arange(len(made["isect_ids"]))
        swapped[[0, 1]] = [1, 0]
        nothing = numpy.where(numpy.arange(120)[:, None] == largest, 0, made["radii"])
        near = made["depths"] * (1 + 1e-4)
        for stage, name, changed in (
                ("projection", "means2d", {"means2d": given["means2d"] + 0.5}),
                ("projection", "conics", {"conics": given["conics"] * [1, 0.5, 1]}),
                ("projection", "radii", {"radii": made["radii"] + 1}),
                ("projection", "radii", {"radii": nothing}),
                ("projection", "depths", {"depths": near}),
                ("projection", "gaussian_ids", {name: array[:-1] if name != "flatten_ids" and len(array) == len(shown)
                                                else array for name, array in packed.items()}),
                ("sort", "isect_ids", {name: given[name][swapped] for name in ("isect_ids", "flatten_ids")}),
                ("sort", "isect_ids", {name: given[name][made["isect_ids"] >> 32 < 4]
                                       for name in ("isect_ids", "flatten_ids")}),
                ("sort", "isect_ids", {"isect_ids": given["isect_ids"] & ~0xffff}),
                ("sort", "tiles_per_gauss", {"tiles_per_gauss": made["tiles_per_gauss"] + 1}),
                ("sort", "isect_offsets", {"isect_offsets": made["isect_offsets"] + 1}),
                ("alpha", "opacities", {"opacities": given["opacities"] * 0.99}),
                ("color", "colors", {"colors": given["colors"][:, ::-1]}),
                ("blending", "render_colors", {"render_colors": colors})):
            if stage == "blending":
                colors = colors * 0.99
            with self.assertRaises(PictureMismatch) as caught:
                judged(**changed)
            said = caught.exception.verdict
            first = [array["name"] for array in said["arrays"] if array["wrong"]][0]
            self.assertEqual((said["stage"], first), (stage, name), said)
        alphas = alphas + 2  # so that all of the worst pixels are of alpha
        with self.assertRaises(PictureMismatch) as caught:
            judged()
        worst = next(a for a in caught.exception.verdict["arrays"] if a["name"] == "render_colors")["worst"]
        self.assertAlmostEqual(worst["found"], float(colors.reshape(-1, 3)[worst["row"], worst["column"]]), 6)
        self.assertGreater(worst["found"], 0)
        with self.assertRaisesRegex(conic.InputError, "one camera at a time"):
            judged(means2d=numpy.zeros((2, 120, 2)))

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
