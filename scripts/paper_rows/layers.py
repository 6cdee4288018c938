"""Layered Point Clouds (Gobbetti, Marton)."""

import pathlib

from .page import FULL, OTHER, PARTLY, Rows
from .tools import Absent, import_numpy, read_positions, thousands

TITLE = "Layered Point Clouds"
INTRODUCTION = """
A binary tree of small clouds that add up, drawn out of core and over networks. Its models are not public: the gyroid of
`conic make` stands in for the isosurface, the lion for the scans.
"""
ROWS = Rows()
add, words = ROWS.add, ROWS.words

words("L1", "§3: a binary tree of M samples a node; samples are only regrouped", FULL, "conic layer --cloud-size M",
      "`test_layers_build`")
words("L2", "Eqs. 1–2: a node's radius from how many samples it has", OTHER, "conic layer",
      "The radius is measured: what covers the finer samples, 0.65–1.2 spacings ([measured](../notes/layers-measured.md))")
words("L3", "§5: K · M samples at random, shuffled, M taken", OTHER, "conic layer",
      "Poisson discs: no two samples of a level are nearer than 0.65 spacings")


def make_gyroid(bench, count):
    return bench.once(f"gyroid{count}.ply", lambda out: bench.run("make", "gyroid", "-n", count, "-o", out))


def layer_gyroid(bench, count, size=2048):
    points = make_gyroid(bench, count)
    return bench.once(f"gyroid{count}-{size}.lpc",
                      lambda out: bench.run("layer", points, "-o", out, "--cloud-size", size))


@add("L4", "§3: M of 512 to 8192 is best", FULL, "conic layer --cloud-size M",
     "The default of 2,048 packs better: 38.8 bits a sample, at 1,024 40.5")
def _(bench):
    sizes = (64, 512, 1024, 2048, 4096, 8192)
    frame = ("--size", "512x512", "--error", 4)
    files = [layer_gyroid(bench, "2M", size) for size in sizes]
    times = bench.frames_in_turns(5, *((file, *frame) for file in files))
    texts = [f"{size}: {ms:.0f} ms, {bench.render(file, *frame)['splats_in'] / 1e3:.0f} K splats"
             for size, ms, file in zip(sizes, times, files)]
    return "gyroid of 2 M, 4 px: " + "; ".join(texts)


words("L5", "Figs. 1, 4: levels that add up, and the boxes of the subdivision", FULL,
      "conic render x.lpc --progressive DIR; conic render x.lpc --show boxes:OUT.png",
      "[picture](../pictures/papers/places.png)")
words("L6", "§4, Fig. 2: an index, a repository by level and Morton code, a cache, reading beside drawing", FULL,
      "conic layer", "[The format](format-lpc.md)")


@add("L7", "§4, Table 1: quantised, as differences, compressed: 33–40 bits a sample, place and normal", FULL,
     "conic info x.lpc", quick=True)
def _(bench):
    texts = []
    for name, file in (("lion", bench.model("lion.ply")), ("gyroid of 1 M", make_gyroid(bench, "1M"))):
        bench.run("layer", file, "-o", bench.path("bits.lpc"))
        bits = bench.run("info", bench.path("bits.lpc"))["bits"]
        texts.append(f"{name} {bits['position'] + bits['normal'] + bits['index']:.1f}")
    return ", ".join(texts)


@add("L8", "Table 1: 4.1, 28, 167 and 234 M samples, 18–30 K samples/s; files 4.8–5.8 times as small; depth over 100", FULL,
     "scripts/layers-large 234M", "Largest tried: see [measured](../notes/layers-measured.md)")
def _(bench):
    texts = []
    for count in ("4138653", "28120980"):
        points = make_gyroid(bench, count)
        report = bench.run("layer", points, "-o", bench.path("large.lpc"))
        texts.append(f"{int(count) / 1e6:.1f} M: {report['points_per_s'] / 1e6:.1f} M samples/s, "
                     f"{pathlib.Path(points).stat().st_size / report['bytes']:.1f} times as small")
    return "; ".join(texts)


@add("L9", "§6: below QSplat's 50 bits a sample; quantising each cluster by itself would do better", FULL, "conic layer",
     "Places are coded within their cloud. Draco has no levels: it is read whole")
def _(bench):
    numpy = import_numpy()
    try:
        import DracoPy
    except ImportError as error:
        raise Absent("DracoPy is not there") from error
    report = bench.run("layer", bench.model("lion.ply"), "-o", bench.path("bits.lpc"))
    info = bench.run("info", bench.path("bits.lpc"))
    places = read_positions(bench, bench.model("lion.ply"))
    n_bits = int(numpy.ceil(numpy.log2(numpy.ptp(places, axis=0).max() / info["quantum"])))
    packed = DracoPy.encode(places.astype("f4"), quantization_bits=n_bits, compression_level=10)
    return (f"places of the lion in steps of half a spacing: {info['bits']['position']:.1f} bits of "
            f"{report['points_out']:,} samples, Draco {8 * len(packed) / len(places):.1f} ({n_bits} bits an axis)")


words("L10", "§4: where children are missing, the parent is drawn, larger", FULL, "conic render --deadline S",
      "JSON `places_coarser` says how many")
words("L11", "§4: a queue by priority asks for as many clouds as the link allows", FULL, "conic render URL --deadline S",
      "Level by level, small ranges first, each cloud as its bytes come ([measured](../notes/layers-measured.md#a-slow-link))")
words("L12", "§4: a projected bound decides what is refined", FULL, "conic render --error PX",
      "A bound, so 1.0–1.9 times what is true ([measured](../notes/layers-measured.md))")


@add("L13", "§6: up to 10 % more points than QSplat at the same tolerance", PARTLY, "conic render lion.lpc --error 1",
     "A cloud is refined as a whole, and its bound is of its farthest sample; the octree refines each splat")
def _(bench):
    bench.octree("lion.ply")
    bench.once("lion.lpc", lambda out: bench.run("layer", bench.model("lion.ply"), "-o", out))
    texts = []
    size = ("--size", "512x512", "--shade", "none")
    bench.render(bench.model("lion.ply"), *size, out="whole.pfm")
    for error in (1, 2):
        found = []
        for file in ("lion.lpc", "lion.cot"):
            report = bench.render(bench.path(file), *size, "--error", error, out="near.pfm")
            found.append(f"{thousands(report['splats_in'])} at {bench.decibels('whole.pfm', 'near.pfm'):.1f} dB")
        texts.append(f"{error} px: layers {found[0]}, octree {found[1]}")
    return "lion, 512²: " + "; ".join(texts)


words("L14", "§4: a number of points is kept by a search for the tolerance", FULL, "conic render --budget N",
      "Exact")
words("L15", "§4, Fig. 3: occlusion leaves out 27 % of the patches, 24 → 6.3 M points, 3.2 times as fast; half is not read",
      PARTLY, "conic render --occlusion on",
      "28 → 9.1 M splats, 1.3 times as fast; but all is read: no place of the gyroid is hidden to the last splat, and a "
      "picture keeps its bits")
words("L16", "§6: memory is 27 % of the data", FULL, "conic render --memory 64", "61 MiB of 390 MB (100 M samples)")
words("L17", "§6: 40 M splats/s, at most 68 M; 30 M with occlusion", PARTLY, "conic bench",
      "16–21 M/s a core, as filtered splats, not as points of one colour")
words("L18", "§6, Fig. 5: pictures that come over 1.25 Mbit/s", FULL, "conic render URL --error 1 --deadline S",
      "The lion, 1.8 MB: 26 dB at 1.2 s, 34 at 4, 41 at 8, whole at 12.6; `curl` takes 11.9 "
      "([measured](../notes/layers-measured.md#a-slow-link))")
words("L19", "§6: coarse pictures alias; to be improved", FULL, "conic layer",
      "Averaging colours was tried: +0.3–0.5 dB, not kept; splats are drawn through the prefilter")
words("L20", "Future: a size, texture and transparency for each sample", FULL,
      "conic layer --payload full; conic render --transparency")
DEPARTURES = [
    "Samples are chosen by Poisson discs, and spacing is measured, not reckoned from counts.",
    "What is projected is a bound of a place's error, not the mean distance of its samples.",
    "A sample has the outline of the finest place that it lies in, and is filtered like any splat.",
]
