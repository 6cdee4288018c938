"""What the rows share: conic run on a model, its statistics, tests that print a number, decibels."""

import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile


class Absent(Exception):
    """A model, a program or a package that is not there."""


class Workbench:
    """A folder of temporary files, and conic to fill it."""

    def __init__(self, root):
        self.root = root
        self.data = root.parent / "shared" / "data"
        self.program = os.environ.get("CONIC", str(root / "build" / "bin" / "conic"))
        self.known = {}

    def __enter__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="papers-"))
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder)

    def path(self, name):
        return str(self.folder / name)

    def model(self, name):
        if not (self.data / name).exists():
            raise Absent(f"{name} is not there")
        return str(self.data / name)

    def run(self, *words, may_differ=False):
        """Runs conic and gives its statistics."""
        report = self.path("run.json")
        if not pathlib.Path(self.program).exists():
            raise Absent(f"{self.program} is not built")
        command = [self.program, *map(str, words), "--quiet", "--json", report]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode > (1 if may_differ else 0):
            raise RuntimeError(f"{' '.join(command)}: {done.stderr}")
        with open(report, encoding="utf-8") as file:
            return json.load(file)

    def render(self, file, *words, out="out.pfm"):
        """As the library draws by default: one sample, framed by a sphere."""
        return self.run("render", file, "-o", self.path(out), "--plain", *words)

    def once(self, name, make):
        """A file that several rows use, made the first time."""
        if name not in self.known:
            self.known[name] = make(self.path(name))
        return self.path(name)

    def octree(self, model):
        return self.once(pathlib.Path(model).stem + ".cot",
                         lambda out: self.run("octree", self.model(model), "-o", out, "--threads", 1))

    def frames_in_turns(self, rounds, *commands):
        """The median ms of a frame of each command, a file and its options, that are drawn in turns by one thread."""
        times = [[] for _ in commands]
        for _ in range(rounds):
            for found, (file, *words) in zip(times, commands):
                found.append(self.render(file, "--threads", 1, "--repeat", 3, *words)["ms"]["frame"])
        return [sorted(found)[rounds // 2] for found in times]

    def decibels(self, whole, near):
        """PSNR over rgba between two pictures of the folder."""
        rmse = self.run("diff", self.path(whole), self.path(near), may_differ=True)["planes"]["rgba"]["rmse"]
        return -20 * math.log10(rmse) if rmse else math.inf

    def test(self, name, *patterns):
        """What a test program prints, by patterns; a test that fails is an error."""
        program = self.root / "build" / "bin" / name
        if not program.exists():
            raise Absent(f"{name} is not built")
        done = subprocess.run([program], capture_output=True, text=True, check=False, cwd=self.root)
        if done.returncode:
            raise RuntimeError(f"{name}: {done.stdout}{done.stderr}")
        found = [re.findall(pattern, done.stdout + done.stderr) for pattern in patterns]
        if not all(found):
            raise Absent(f"{name} printed no number, as where its model is missing")
        return found


def import_numpy():
    try:
        import numpy
    except ImportError as error:
        raise Absent("numpy is not there") from error
    return numpy


def read_floats(file):
    """The numbers of a PFM, the lowest row first."""
    numpy = import_numpy()
    with open(file, "rb") as source:
        _, _, scale = source.readline(), source.readline(), float(source.readline())
        return numpy.frombuffer(source.read(), "<f4" if scale < 0 else ">f4")


def read_positions(bench, file):
    """The places of an OBJ's vertices, or of any other points."""
    numpy = import_numpy()
    if file.endswith(".obj"):
        with open(file, encoding="utf-8") as source:
            return numpy.array([line.split()[1:4] for line in source if line.startswith("v ")], dtype="f8")
    bench.run("prepare", file, "-o", bench.path("points.ply"))
    with open(bench.path("points.ply"), "rb") as source:
        header = [line.decode().split() for line in iter(source.readline, b"end_header\n")]
        n_points = next(int(parts[2]) for parts in header if parts[:2] == ["element", "vertex"])
        columns = [(parts[2], {"float": "<f4", "double": "<f8", "uchar": "u1"}[parts[1]]) for parts in header
                   if parts[0] == "property"]
        table = numpy.fromfile(source, dtype=columns, count=n_points)
    return numpy.stack([table[axis].astype("f8") for axis in "xyz"], axis=1)


def thousands(number):
    return f"{number:,.0f}"
