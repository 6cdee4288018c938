"""Arrays are drawn as the same numbers in a file are."""

import os
import tempfile
import unittest

import numpy

import conic
from drawn_by_program import hashes

SIZE = (96, 72)
WORDS = ("--size", "96x72")


def write_ply(path, names, types, columns, faces=None):
    table = numpy.zeros(len(columns[0]), [(name, kind) for name, kind in zip(names, types)])
    for name, column in zip(names, columns):
        table[name] = column
    ply = {"<f4": "float", "<f8": "double", "u1": "uchar"}
    with open(path, "wb") as file:
        lines = ["ply", "format binary_little_endian 1.0", "comment conic has linear colours",
                 f"element vertex {len(table)}"]
        lines += [f"property {ply[kind]} {name}" for name, kind in zip(names, types)]
        if faces is not None:
            lines += [f"element face {len(faces)}", "property list uchar uint vertex_indices"]
        file.write(("\n".join(lines + ["end_header", ""])).encode())
        file.write(table.tobytes())
        if faces is not None:
            rows = numpy.zeros(len(faces), [("n", "u1"), ("corners", "<u4", 3)])
            rows["n"], rows["corners"] = 3, faces
            file.write(rows.tobytes())


class Arrays(unittest.TestCase):

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def assert_same(self, picture, wanted):
        self.assertEqual(dict(picture.statistics["hash"].items()), wanted)

    def test_bare_positions(self):
        points = numpy.random.default_rng(3).random((200, 3), numpy.float32)

        class OfGpu:
            device = "cuda:0"

            def cpu(self):
                return points

            def __array__(self, *_):
                raise TypeError("can't convert a cuda tensor to numpy")

        wanted = conic.render(conic.Splats(points), size=SIZE).statistics["hash"]
        for scene in (points, [points], OfGpu(), conic.Splats(OfGpu())):
            self.assertEqual(conic.render(scene, size=SIZE).statistics["hash"], wanted)
        with self.assertRaisesRegex(conic.ArgumentError, r"\(3, 200\), and \(N, 3\) is needed"):
            conic.render(points.T, size=SIZE)

    def test_splats_of_all_shapes(self):
        scene = conic.make("knot", n=3000)
        wanted = hashes(scene.path, *WORDS)
        read = scene.splats()
        parts = {name: getattr(read, name) for name in ("position", "tangent_u", "tangent_v", "color")}
        rows = conic.Splats(**{name: numpy.ascontiguousarray(part) for name, part in parts.items()})
        backwards = conic.Splats(**{name: part[::-1].copy()[::-1] for name, part in parts.items()})
        whole = numpy.concatenate(list(parts.values()), axis=1).astype(numpy.float32)
        self.assertTrue(whole.flags.c_contiguous)
        views = conic.Splats(whole[:, 0:3], whole[:, 3:6], whole[:, 6:9], whole[:, 9:12])
        doubles = conic.Splats(*(part.astype(numpy.float64) for part in parts.values()))
        for splats in (read, rows, backwards, views, doubles):
            self.assert_same(conic.render(splats, size=SIZE), wanted)

    def test_no_copy_is_made(self):
        position = numpy.zeros((5, 3), numpy.float32)
        splats = conic.Splats(position)
        self.assertEqual(splats._struct.position[1], position.ctypes.data + 4)
        self.assertEqual(splats._struct.strides.position, 12)
        columns = [numpy.arange(5, dtype=numpy.float32) for _ in range(3)]
        self.assertEqual(list(conic.Splats(tuple(columns))._struct.position), [c.ctypes.data for c in columns])

    def test_array_libraries(self):

        class OnlyDlpack:  # as an array of jax or cupy
            def __init__(self, array):
                self.array = array

            def __dlpack__(self, **words):
                return self.array.__dlpack__(**words)

            def __dlpack_device__(self):
                return self.array.__dlpack_device__()

        class Tensor(OnlyDlpack):  # as one of torch that gradients go through
            device = "cpu"

            def detach(self):
                return OnlyDlpack(self.array)

        array = numpy.arange(12, dtype=numpy.float32).reshape(4, 3)
        for kind in (OnlyDlpack, Tensor):
            self.assertEqual(conic.Splats(kind(array))._struct.position[0], array.ctypes.data)
        on_device = OnlyDlpack(array)
        on_device.device = "cuda:0"
        with self.assertRaisesRegex(conic.ArgumentError, r"cuda:0.*\.cpu"):
            conic.Splats(on_device)

    def test_points_become_splats(self):
        generator = numpy.random.default_rng(1)
        places = generator.normal(size=(800, 3))
        places = (places / numpy.linalg.norm(places, axis=1)[:, None]).astype(numpy.float32)
        write_ply(self.path("points.ply"), "xyz", ["<f4"] * 3, places.T)
        self.assert_same(conic.render(conic.Splats(places), size=SIZE), hashes(self.path("points.ply"), *WORDS))

    def test_far_doubles_and_broken_axes(self):
        scene = conic.make("sphere", n=2000).splats()
        place = scene.position.astype(numpy.float64) + [4e6, 5e6, 100.0]
        u, v = scene.tangent_u.copy(), scene.tangent_v.copy()
        u[10] = 0.0
        v[20, 1] = numpy.nan
        place[30, 2] = numpy.inf
        names = ["x", "y", "z", "tu_x", "tu_y", "tu_z", "tv_x", "tv_y", "tv_z"]
        write_ply(self.path("far.ply"), names, ["<f8"] * 3 + ["<f4"] * 6, [*place.T, *u.T, *v.T])
        wanted = hashes(self.path("far.ply"), *WORDS)
        for strided in (True, False):
            axes = (u, v) if strided else (tuple(u.T.copy()), tuple(v.T.copy()))
            self.assert_same(conic.render(conic.Splats(place, *axes), size=SIZE), wanted)

    def test_one_unsound_number(self):
        scene = conic.make("sphere", n=501).splats()
        names = ("position", "tangent_u", "tangent_v", "color")
        columns = "x y z tu_x tu_y tu_z tv_x tv_y tv_z red green blue".split()
        for at in (0, 499, 500):
            for name, value in (("position", numpy.nan), ("tangent_u", numpy.inf), ("tangent_u", 0.0),
                                ("tangent_v", -0.0), ("color", numpy.nan)):
                with self.subTest(at=at, name=name, value=value):
                    parts = {part: getattr(scene, part).copy() for part in names}
                    parts[name][at] = value
                    write_ply(self.path("one.ply"), columns, ["<f4"] * 12, numpy.concatenate([*parts.values()], 1).T)
                    alone = conic.Splats(**{part: tuple(array.T.copy()) for part, array in parts.items()})
                    self.assert_same(conic.render(alone, size=SIZE), hashes(self.path("one.ply"), *WORDS))

    def test_gaussians(self):
        made = conic.make("gaussians", n=400, seed=3)
        arrays = made.gaussians()
        again = conic.Gaussians(arrays.means, arrays.quats, arrays.scales, arrays.opacities[:, None], arrays.sh,
                                frame=arrays.frame)
        for words in ((), ("--profile", "gsplat-1.6"), ("--profile", "surface")):
            profile = words[1] if words else None
            wanted = hashes(made.path, *WORDS, *words)
            if profile != "surface":
                self.assert_same(conic.render(arrays, size=SIZE, profile=profile), wanted)
            self.assert_same(conic.render(again, size=SIZE, profile=profile), wanted) if profile != "surface" else None
            self.assert_same(conic.render(made, size=SIZE, profile=profile), wanted)
        self.assertEqual(conic.render(arrays, size=SIZE, profile="surface")["rgba"].shape, (72, 96, 4))
        for n in (1, 2, 3, 4):  # as many rows as there may be components
            few = conic.make("gaussians", n=n, seed=3)
            self.assert_same(conic.render(few.gaussians(), size=SIZE), hashes(few.path, *WORDS))
            self.assertEqual(few.gaussians().means.shape, (n, 3))
        with self.assertRaisesRegex(conic.ArgumentError, "sh: its shape"):
            conic.Gaussians(arrays.means, arrays.quats, arrays.scales, arrays.opacities, arrays.sh[:, :5])

    def test_meshes(self):
        corners = numpy.float32([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        faces = numpy.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                             [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
        colors = (corners * 0.25 + 0.5).astype(numpy.float32)
        write_ply(self.path("cube.ply"), ["x", "y", "z", "red", "green", "blue"], ["<f4"] * 6,
                  [*corners.T, *colors.T], faces)
        for words in ((), ("--as", "points"), ("--as", "hybrid"), ("--smooth",)):
            options = {"as_": words[1]} if len(words) > 1 else {"smooth": bool(words)}
            with self.subTest(words=words):
                picture = conic.render(conic.Mesh(corners, faces, colors), size=SIZE, **options)
                self.assert_same(picture, hashes(self.path("cube.ply"), "--colors", "linear", *WORDS, *words))
        with self.assertRaisesRegex(conic.ArgumentError, "faces: an index"):
            conic.Mesh(corners, faces + 1)

    def test_rows_of_far_doubles(self):
        place = [[4000000.25 + i, 5e6, 0.0625 * i] for i in range(5)]
        for position in (place, tuple(numpy.array(place).T), numpy.asmatrix(place)):
            splats = conic.Splats(position)
            self.assertTrue(numpy.array_equal(splats.position.astype("f8") + splats.origin, place))

    def test_messages_name_what_was_lent(self):
        with self.assertRaisesRegex(conic.InputError, r"^conic\.Splats: cannot be drawn: it holds no points$"):
            conic.render(conic.Splats(numpy.zeros((0, 3))), size=SIZE)
        mirrored = conic.Camera.from_K(numpy.diag([-1.0, 1, 1, 1]), numpy.diag([50.0, 50, 1]), *SIZE)
        with self.assertRaisesRegex(conic.InputError, r"^conic\.Camera: the camera's cam_from_world mirrors$"):
            conic.render(conic.Splats(numpy.eye(3)), mirrored)

    def test_what_cannot_be_meant(self):
        points, ones = numpy.eye(3) + numpy.arange(3)[:, None], numpy.ones((3, 3))
        for call in (lambda: conic.Splats(([1.0, 2.0], [1.0], [1.0, 2.0])), lambda: conic.Splats([[1, 2, 3], [1, 2]]),
                     lambda: conic.Splats(points, origin=(1, 2)), lambda: conic.Splats(points, origin="abc"),
                     lambda: conic.Splats(numpy.ma.masked_greater(points, 1.0)),
                     lambda: conic.Splats(points, color=numpy.zeros((3, 3), numpy.uint8)),
                     lambda: conic.Gaussians(points, numpy.ones((3, 4)), 0.1, ones[0], ones),
                     lambda: conic.Gaussians(points, numpy.ones((3, 4)), ones, ones[0], numpy.ones((3, 5))),
                     lambda: conic.Gaussians(points, numpy.ones((3, 4)), ones, ones[0], ones, frame="xyz"),
                     lambda: conic.Camera.look_at((0, 3)), lambda: conic.Camera.look_at("abc"),
                     lambda: conic.Camera.look_at((0, 0, 3), width=0),
                     lambda: conic.Camera.look_at((0, 0, 3), width=48.5),
                     lambda: conic.Camera.from_K(numpy.stack([numpy.eye(4)] * 2), numpy.eye(3), 8, 8),
                     lambda: conic.render(conic.Splats(points), (0, 0, 3)),
                     lambda: conic.prepare(conic.Splats(points), in_place=True),
                     lambda: conic.render(conic.Splats(points), size=(48.5, 36)),
                     lambda: conic.render(conic.Splats(points), size=("a", 36))):
            with self.assertRaises(conic.ArgumentError):
                call()

    def test_shapes_that_do_not_fit(self):
        for arguments in ((numpy.zeros((3, 2)),), (numpy.zeros((3, 3)), numpy.zeros((3, 3))),
                          (numpy.zeros((3, 3)), None, None, numpy.zeros((4, 3))), (numpy.array(["a"] * 3),)):
            with self.assertRaises(conic.ArgumentError):
                conic.Splats(*arguments)


if __name__ == "__main__":
    unittest.main()
