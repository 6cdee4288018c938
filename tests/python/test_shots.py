"""Shots: pictures as one value, and what a scene keeps."""

import copy
import ctypes
import dataclasses
import inspect
import os
import pickle
import tempfile
import unittest
import warnings

import numpy

import conic
from conic import _layouts as layouts
from conic import _shot
from conic._library import library
from drawn_by_program import conic as program
from drawn_by_program import hashes

SIZE = (48, 40)
WORDS = ("--size", "48x40")
IS_SANITIZED = "LD_PRELOAD" in os.environ  # where a start of the program takes ten times as long

# What a picture may be asked for, and the same for the program.
OPTIONS = (
    ({}, ()),
    ({"azimuth": 40.5, "zoom": 2}, ("--azimuth", "40.5", "--zoom", "2")),
    ({"fov": numpy.float32(30), "elevation": -12}, ("--fov", "30", "--elevation", "-12")),
    ({"samples": numpy.int64(1), "exposure": 0.1}, ("--samples", "1", "--exposure", "0.1")),
    ({"exposure": "auto"}, ("--exposure", "auto")),
    ({"background": (0.1, 0.2, 0.7)}, ("--background", "0.1,0.2,0.7")),
    ({"background": "0.1:0.5"}, ("--background", "0.1:0.5")),
    ({"method": "conic", "kernel": "hat"}, ("--method", "conic", "--kernel", "hat")),
    ({"shade": "lambert", "light": [(1, 2, 3), "head:1,0.5,0"]},
     ("--shade", "lambert", "--light", "1,2,3", "--light", "head:1,0.5,0")),
    ({"light": "lamp:3,3,3:9,9,9", "shadow": True}, ("--light", "lamp:3,3,3:9,9,9", "--shadow")),
    ({"ao": 8, "sky": (0.1, 0.2, 0.3)}, ("--ao", "8", "--sky", "0.1,0.2,0.3")),
    ({"accumulate": 3, "aperture": 0.1}, ("--accumulate", "3", "--aperture", "0.1")),
    ({"accumulate": "2", "aperture": "3x", "blades": 5, "focus": "20,20"},
     ("--accumulate", "2", "--aperture", "3x", "--blades", "5", "--focus", "20,20")),
    ({"cull": "back", "near": 0.1}, ("--cull", "back", "--near", "0.1")),
    ({"epsilon": "2x", "cutoff": 2}, ("--epsilon", "2x", "--cutoff", "2")),
    ({"projection": "panorama"}, ("--projection", "panorama")),
    ({"projection": "fisheye", "fov": 150, "ao": 4, "accumulate": 2},
     ("--projection", "fisheye", "--fov", "150", "--ao", "4", "--accumulate", "2")),
    ({"eye": (1, 2, 3), "up": "z"}, ("--eye", "1,2,3", "--up", "z")),
    ({"up": (0.1, 1, 0)}, ("--up", "0.1,1,0")),
    ({"planes": ["N", "id", "P"]}, ("--aov", "N,id,P")),
    ({"color_by": "height", "legend": None}, ("--color-by", "height")),
    ({"transparency": True}, ("--transparency",)),
    ({"plain": True}, ("--plain",)),
    ({"passes": 1, "prefilter": 0.5}, ("--passes", "1", "--prefilter", "0.5")),
    ({"method": "patch", "degree": 2}, ("--method", "patch", "--degree", "2")),
)

# Of these, what is drawn of what was read for the first picture.
OTHERWISE_READ = {"color_by", "transparency", "plain", "degree", "cutoff"}
OF_THE_PICTURE = [options for options, _ in OPTIONS if not set(options) & OTHERWISE_READ]

class Shots(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.scene = conic.make("knot", cls.path("knot.ply"), n=3000)
        with open(cls.path("mesh.obj"), "w", encoding="utf-8") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 1 1 0.2\nv 0 1 0\nf 1 2 3 4\n")
        cls.gaussians = conic.make("gaussians", cls.path("gaussians.ply"), n=300)
        warnings.simplefilter("ignore", conic.ConicWarning)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()
        warnings.resetwarnings()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def assert_drawn_again(self, scene, picture):
        again = conic.render(scene, picture.shot)
        self.assertEqual(again.planes, picture.planes)
        self.assertEqual(again.statistics["hash"], picture.statistics["hash"])
        self.assertEqual(again.shot, picture.shot)
        self.assertEqual(again.is_display, picture.is_display)
        return again

    def test_options_and_their_shots(self):
        for options, words in OPTIONS:
            with self.subTest(options=options):
                picture = conic.render(self.scene, size=SIZE, **options)
                wanted = hashes(self.scene.path, *WORDS, *words)  # also of planes that are drawn for others
                self.assertEqual(picture.statistics["hash"], {name: wanted[name] for name in picture.planes})
                self.assert_drawn_again(self.scene, picture)

    def test_other_sources(self):
        mesh = conic.open(self.path("mesh.obj"))
        tree = conic.octree(self.scene, self.path("knot.cot"))
        for scene, options in ((mesh, {}), (mesh, {"as_": "points"}), (mesh, {"smooth": True}),
                               (mesh, {"as_": "hybrid"}), (tree, {}), (tree, {"error": 2}), (tree, {"budget": 500}),
                               (self.gaussians, {"profile": "gsplat-1.6"}), (self.gaussians, {"profile": "surface"}),
                               (self.gaussians, {"planes": ["rgba", "T", "medianZ"]}),
                               ([self.scene, mesh], {}), (self.scene.splats(), {"ao": 4})):
            with self.subTest(scene=scene, options=options):
                self.assert_drawn_again(scene, conic.render(scene, size=SIZE, **options))
        views = conic.render(self.scene, size=SIZE, turntable=3, accumulate=2, shutter="0:0.5")
        eyes = conic.render(self.scene, size=SIZE, stereo=0.2)
        self.assertEqual((len(views), len(eyes)), (3, 2))
        self.assertNotEqual(eyes[0].statistics["hash"]["rgba"], conic.render(self.scene, size=SIZE).hash())
        for picture in views + eyes:
            self.assert_drawn_again(self.scene, picture)

    def test_sky_of_a_picture(self):
        conic.render(self.scene, size=(32, 16), projection="panorama", output=self.path("sky.exr"))
        picture = conic.render(self.scene, size=SIZE, sky=self.path("sky.exr"), ao=8)
        self.assertEqual(picture.shot.light.sky, self.path("sky.exr"))
        self.assert_drawn_again(self.scene, picture)

    # Files of shots

    def assert_is_the_program_s(self, name, shot, *arguments):
        """The file, the key and the bits are those of the program with the same options."""
        ours, its = self.path(f"{name}.ours.shot.json"), self.path(f"{name}.its.shot.json")
        told = program("render", *arguments, "-o", self.path(f"{name}.exr"), "--save-shot", its)
        if shot.light.n_directions or shot.light.has_shadows:  # arrays have the planes that light needs, files have not
            self.assertEqual(shot.planes, ("rgba", "Z", "N", "albedo"))
            shot = dataclasses.replace(shot, planes=("rgba", "Z"))
        shot.save(ours)
        with open(ours, encoding="utf-8") as one, open(its, encoding="utf-8") as other:
            self.assertEqual(one.read(), other.read())
        self.assertEqual(shot.key(), told["shot_key"])
        for path in (its, self.path(f"{name}.exr")):
            opened = conic.Shot.open(path)
            self.assertEqual(opened.key(), told["shot_key"])
            drawn = conic.render([known.name for known in opened.inputs if known.role == "scene"], opened)
            self.assertEqual(drawn.statistics["hash"], {name: told["hash"][name] for name in drawn.planes})
            if path == its:
                opened.save(ours)
                with open(ours, encoding="utf-8") as one, open(its, encoding="utf-8") as other:
                    self.assertEqual(one.read(), other.read())
                self.assertEqual(conic.Shot.open(ours), opened)
                self.assertEqual(hashes(ours), told["hash"])

    def test_files_are_the_program_s(self):
        for i, (options, words) in enumerate(OPTIONS[::1 + 3 * IS_SANITIZED]):
            with self.subTest(options=options):
                picture = conic.render(self.scene, size=SIZE, **options)
                self.assert_is_the_program_s(f"o{i}", picture.shot, self.scene.path, *WORDS, *words)

    def test_files_of_other_sources(self):
        conic.render(self.scene, size=(32, 16), projection="panorama", output=self.path("dome.exr"))
        with open(self.path("motion.json"), "w", encoding="utf-8") as file:
            file.write('[{"input": 0, "frame": 1, "file": "moved.ply"}]')
        conic.make("knot", self.path("moved.ply"), n=3000, jitter=0.3)
        with open(self.path("lit.obj"), "w", encoding="utf-8") as file:
            file.write("mtllib lit.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0.2\nusemtl a\nf 1 2 3\n")
        with open(self.path("lit.mtl"), "w", encoding="utf-8") as file:
            file.write("newmtl a\nKd 0.5 0.6 0.7\n")
        for i, (path, options, words) in enumerate((
                (self.gaussians.path, {}, ()),
                (self.gaussians.path, {"profile": "gsplat-1.6"}, ("--profile", "gsplat-1.6")),
                (self.path("lit.obj"), {}, ()),  # which leads to another file
                (self.scene.path, {"sky": self.path("dome.exr"), "ao": 4}, ("--sky", self.path("dome.exr"), "--ao", 4)),
                (self.scene.path, {"accumulate": 3, "motion": self.path("motion.json"), "shutter": "0:1"},
                 ("--accumulate", 3, "--motion", self.path("motion.json"), "--shutter", "0:1")))):
            with self.subTest(path=path, options=options):
                scene = conic.open(path)
                conic.render(scene, size=SIZE)  # of what is kept, nothing is read again
                shot = conic.render(scene, size=SIZE, **options).shot
                self.assert_is_the_program_s(f"s{i}", shot, path, *WORDS, *words)
        self.assertIn("part", [known.role for known in conic.Shot.open(self.path("s2.exr")).inputs])

    def test_pictures_carry_shots(self):
        picture = conic.render(self.scene, size=SIZE, exposure=0.5)
        program("render", self.scene.path, *WORDS, "--exposure", "0.5", "-o", self.path("its.exr"))
        for ending in ("exr", "png", "tif"):
            with self.subTest(ending=ending):
                path = self.path(f"carries.{ending}")
                picture.save(path, shot=True)
                shot = conic.Shot.open(path)
                self.assertEqual(conic.render(self.scene, shot).hash(), picture.hash())
                self.assertEqual(shot.key(), picture.shot.key())
                self.assertEqual(hashes("--again", path)["rgba"], picture.hash())
                picture.save(path)
                with self.assertRaisesRegex(conic.InputError, "how it was made"):
                    conic.Shot.open(path)
        self.assertEqual(conic.Shot.open(self.path("its.exr")).text(), picture.shot.text())
        with self.assertRaisesRegex(conic.ArgumentError, "nobody knows"):
            conic.Picture({"rgba": picture["rgba"]}).save(self.path("none.exr"), shot=True)

    def test_files_of_arrays_and_of_maps(self):
        splats = self.scene.splats()
        shot = conic.render(splats, size=SIZE, azimuth=30).shot
        shot.save(self.path("arrays.shot.json"))
        again = conic.Shot.open(self.path("arrays.shot.json"))
        self.assertEqual(again.inputs, ())
        self.assertEqual(conic.render(splats, again).hash(), conic.render(splats, shot).hash())
        program("render", self.scene.path, "--camera", "top:0.1", "-o", self.path("map.tif"))
        seen = conic.Shot.open(self.path("map.tif"))
        self.assertTrue(seen.map.is_wanted)
        with self.assertRaisesRegex(conic.ArgumentError, "it is a map"):
            conic.render(self.scene, seen)
        for path, message in ((self.scene.path, "how it was made"), (self.path("missing.exr"), "No such file")):
            with self.assertRaisesRegex(conic.InputError, message):
                conic.Shot.open(path)

    def test_shots_have_every_field(self):
        field, i = layouts.ShotField(), 0
        whole = conic.Shot(conic.render(self.scene, size=SIZE).camera)
        whole.reading.patches, whole.reading.coloring = _shot.Patches(), _shot.Coloring()
        known = {"lights": _shot.Light, "lamps": _shot.Lamp}
        while library.conic_shot_field_at(i, ctypes.byref(field)):
            path, i = field.path.decode(), i + 1
            if path.startswith(("camera.", "way.cameras[]")):  # a Camera has the struct itself
                continue
            value = whole
            for part in path.split("."):
                name = part.rstrip("[]")
                members = {member.metadata.get("member", member.name): member.name
                           for member in dataclasses.fields(value)}
                self.assertIn(name, members, path)
                value = known[name]() if part.endswith("[]") else getattr(value, members[name])
            words = [word.decode() for word in field.words if word]
            if field.kind == 4:
                self.assertIn(value, words, path)
        self.assertGreater(i, 100)

    def test_shots_are_values(self):
        picture = conic.render(self.scene, size=SIZE, light=["head", "lamp:3,3,3:9,9,9"])
        shot = picture.shot
        self.assertEqual([shot.camera, shot.planes, len(shot.render.lighting.lights), len(shot.light.lamps)],
                         [picture.camera, tuple(picture.planes), 1, 1])
        for again in (copy.deepcopy(shot), pickle.loads(pickle.dumps(shot)), pickle.loads(pickle.dumps(picture)).shot):
            self.assertEqual(again, shot)
        brighter = dataclasses.replace(shot, render=dataclasses.replace(shot.render, exposure=1.0))
        self.assertNotEqual(brighter, shot)
        bright, wanted = conic.render(self.scene, brighter), conic.render(self.scene, size=SIZE, exposure=1,
                                                                          light=["head", "lamp:3,3,3:9,9,9"])
        self.assertEqual(bright.hash(), wanted.hash())
        for name, value in (("focus_kind", "nowhere"), ("camera", None), ("planes", ("nothing",)),
                            ("shutter", (1.0,)), ("n_samples", "many")):
            with self.assertRaises(conic.ArgumentError):
                conic.render(self.scene, dataclasses.replace(shot, **{name: value}))
        with self.assertRaisesRegex(conic.ArgumentError, "exposure: a shot says it already"):
            conic.render(self.scene, shot, exposure=1)
        said = conic.render(self.scene, shot).statistics
        for name in ("splats_in", "splats_drawn", "pixels_covered", "near", "epsilon_mode", "overdraw"):
            self.assertEqual(said[name], picture.statistics[name])

    def test_defaults_are_the_library_s(self):
        made = layouts.Shot()
        library.conic_shot_init_sized(ctypes.byref(made), ctypes.sizeof(made))
        camera = conic.Camera(made.camera)
        self.assertEqual(conic.Shot._of(made), conic.Shot(camera))

    def test_statistics_come_when_asked_for(self):
        picture = conic.render(self.scene, size=SIZE)
        self.assertIsNotNone(picture._told)
        self.assertIn("statistics", picture)
        self.assertEqual((len(picture), sorted(picture)), (3, ["Z", "rgba", "statistics"]))
        self.assertEqual(picture.get("statistics"), picture.statistics)
        with self.assertRaises(KeyError):
            picture["N"]  # pylint: disable=pointless-statement

    def test_a_scene_is_read_once(self):
        scene, hidden = conic.make("knot", self.path("read.ply"), n=2000), self.path("hidden.ply")
        wanted = [conic.render(self.path("read.ply"), size=SIZE, **options).hash() if "planes" not in options else None
                  for options in OF_THE_PICTURE]
        first = conic.render(scene, size=SIZE, threads=1)
        os.rename(self.path("read.ply"), hidden)
        for options, known in zip(OF_THE_PICTURE, wanted):
            with self.subTest(options=options):
                drawn = conic.render(scene, size=SIZE, threads=1 + len(options) % 2, **options)
                self.assertIn(known, (None, drawn.hash() if known else None))
        self.assertEqual(len(conic.render(scene, size=SIZE, stereo=0.1)), 2)
        for options in ({"isa": "scalar"}, {"threads": 2}, {"tone": "agx"}):
            self.assertEqual(conic.render(scene, size=SIZE, **options).hash(), first.hash())
        self.assert_drawn_again(scene, first)
        with self.assertRaises(conic.InputError):  # read in another way
            conic.render(scene, size=SIZE, as_="hybrid")
        os.rename(hidden, self.path("read.ply"))
        self.assertEqual(conic.render(scene, size=SIZE).hash(), first.hash())

    def test_a_gaussian_scene_is_read_once(self):
        path, hidden = self.path("scene.ply"), self.path("away.ply")
        scene = conic.make("gaussians", path, n=200)
        profiles = ("exact", "gsplat-1.6", "inria-2023", "exact", "khr-2026")
        wanted = [conic.render(path, size=SIZE, profile=profile).hash() for profile in profiles]
        conic.render(scene, size=SIZE)
        os.rename(path, hidden)
        for profile, known in zip(profiles, wanted):
            self.assertEqual(conic.render(scene, size=SIZE, profile=profile).hash(), known)
        picture = conic.render(scene, size=SIZE, profile="gsplat-1.6")
        self.assertEqual(conic.judge(scene, picture.camera, picture["rgba"], profile="gsplat-1.6")["verdict"], "right")
        self.assertTrue(conic.verify(scene, picture.camera, profile="gsplat-1.6")["pass"])

    def test_signatures(self):
        parameters = inspect.signature(conic.render).parameters
        for name in ("fov", "exposure", "as_", "planes", "output", "accumulate"):
            self.assertEqual(parameters[name].kind, inspect.Parameter.KEYWORD_ONLY)
            self.assertIn(f"    {name}: ", conic.render.__doc__)
        self.assertEqual(parameters["scene"].kind, inspect.Parameter.POSITIONAL_OR_KEYWORD)
        self.assertIn("max_wrong", inspect.signature(conic.judge).parameters)


if __name__ == "__main__":
    unittest.main()
