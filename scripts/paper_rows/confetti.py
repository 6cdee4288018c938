"""Confetti: Object-Space Point Blending and Splatting (Pajarola, Sainz, Guidotti)."""

import math

from .page import ABSENT, FULL, OTHER, PARTLY, Rows
from .tools import import_numpy, read_floats, read_positions

TITLE = "Confetti"
INTRODUCTION = """
Object-space blending of discs, and a point-octree. The scans of its tables are not public; the lion (341,989 points,
without its 49 doubles) stands in for Female (302,948).
"""
ROWS = Rows()
add, words = ROWS.add, ROWS.words
MODELS = ("lion.ply", "bunny.obj", "nefertiti.obj")


def of_models(bench, name_value):
    return ", ".join(f"{model.split('.')[0]} {name_value(bench, model)}" for model in MODELS)


@add("C1", "§3.2, Fig. 3, Table 1: an octree split at the mean, in one pass; 0.10–0.19 M points/s", FULL,
     "conic octree lion.ply --threads 1", quick=True)
def _(bench):
    rates = []
    for model in MODELS:
        report = bench.run("octree", bench.model(model), "-o", bench.path("rate.cot"), "--threads", 1)
        rates.append(f"{model.split('.')[0]} {report['points_per_s'] / 1e6:.2f}")
    return ", ".join(rates) + " M points/s"


@add("C2", "Eqs. 1–4: a covariance in homogeneous form adds up from the leaves", FULL, "test_octree_moments",
     "The printed one, about the world's origin, cancels far from it; ours is about each node's mean, in double: 1e-12 at "
     "5,400 km", quick=True)
def _(bench):
    bench.test("test_octree_moments", r"")
    return "the test holds"


words("C3", "§4.3, Figs. 4–5: a node's ellipse bounds the discs below", FULL, "test_octree_boxes",
      "Ellipses go around the leaves' outlines: a fifth less area and 1.6 dB more than boxes of their radii "
      "([measured](../notes/octree-measured.md))")
words("C4", "§4.3: a point's ellipse bounds its k neighbours", FULL, "conic prepare --ellipse bounding -k 8",
      "Not the default: the Voronoi cell's ellipse is smaller and leaves no holes either "
      "([measured](../notes/estimation.md))")


@add("C5", "Eqs. 5–8: a pixel is Σψc / Σψ", FULL, "conic verify --size 128x128", quick=True)
def _(bench):
    knot = bench.once("knot.ply", lambda out: bench.run("make", "knot", "-n", 6000, "-o", out))
    report = bench.run("verify", knot, "--size", "128x128")
    return f"colours within {report['planes']['rgba']['max_abs']:.1e} of the slow reference, {report['wrong_pixels']} wrong"


def width_and_slope(a, n):
    """Where ψ(a,n) with b = 1.5 is a half, and its greatest fall over a unit of r."""
    steps = 3000
    parts = [(i / steps) ** n for i in range(steps + 1)]
    values = [math.exp(-a * part / (1 - part)) if part < 1 else 0.0 for part in parts]
    slope = max(values[i] - values[i + 1] for i in range(steps)) * steps / 1.5
    return 1.5 * (math.log(2) / (a + math.log(2))) ** (1 / n), slope


@add("C6", "Eqs. 9–10, Fig. 8: of ψ, a sets the width and n the slope", FULL, "scripts/kernels --plot psi.svg",
     "With r/b for r − b ([errata](../notes/errata.md)); [plot](../pictures/papers/psi.svg)", quick=True)
def _(_):
    texts = []
    for a, n in ((1, 2), (6, 3), (5, 4), (4, 5), (3, 6)):
        width, slope = width_and_slope(a, n)
        texts.append(f"ψ({a},{n}) {width:.2f}, {slope:.2f}")
    return "half at r, greatest slope: " + "; ".join(texts)


words("C7", "Fig. 9: a Gaussian of σ 0.5 shows facets, one of 0.8 blurs, ψ(4,5) lies between", FULL, "scripts/paper-pictures",
      "[The lion](../pictures/papers/confetti-9.png) with levels of 0.1 px: σ 0.5 is a cutoff of 3, σ 0.8 of 1.875")
words("C8", "Fig. 15: 512² points of a checkerboard, τ 0.02 %: ψ(1,2) blurs more than ψ(6,3), which still smooths some", FULL,
      "scripts/paper-pictures", "[Levels of 0.1 px, no prefilter](../pictures/papers/confetti-15.png)")
words("C9", "Fig. 16: ψ(4,5) is smooth with detail, ψ(6,3) faceted, τ 0", FULL, "scripts/paper-pictures",
      "[The lion](../pictures/papers/confetti-16.png)")
words("C10", "§8: (3,6) to (5,4) are the best compromise", PARTLY, "scripts/kernels",
      "No kernel is nearest everywhere; of six models' mean ψ(2,2) is, by 0.04 to 0.15 dB ([measured](../notes/kernels.md))")


words("C11", "§6.2, Fig. 11: frustum and normal-cone culling", FULL, "conic render x.cot --cull back")


@add("C12", "§6.2, Fig. 12: a node is drawn where size · cos(γ − θ) < τ", FULL, "test_octree_tilt",
     "Own error × weight in the place of size: fewer splats at the same picture; the paper's rule lives in the test")
def _(bench):
    lines = bench.test("test_octree_tilt", r"(\w+), (\d) px: (\d+) splats, ([\d.]+) dB; .*?, ([\d.]+) dB")[0]
    return "; ".join(f"{name} at {error} px {own} dB, the paper's rule with as many {theirs}"
                     for name, error, _, own, theirs in lines if error == "2")


words("C13", "§6.4, Fig. 14: an ε-z-buffer, ε along the ray", FULL, "conic render --epsilon",
      "Three passes or one: [the picture](picture.md)")
words("C14", "§6.3, 6.5, Figs. 10, 13: α-textures, vertex arrays, shader instructions", OTHER, "",
      "Mechanisms of GPUs of 2004")


@add("C15", "Table 1: 0.396–0.401 inner nodes and 62 bytes a point", FULL, "conic info lion.cot", quick=True)
def _(bench):
    texts = []
    for model in MODELS:
        nodes = bench.run("octree", bench.model(model), "-o", bench.path("nodes.cot"))
        small = bench.run("octree", bench.model(model), "-o", bench.path("small.cot"), "--quantize")
        texts.append(f"{model.split('.')[0]} {nodes['inner_nodes'] / nodes['points_out']:.3f}, "
                     f"{nodes['bytes_per_point']:.1f} (quantised {small['bytes_per_point']:.1f})")
    return "; ".join(texts)


def count_region_nodes(points):
    """Inner nodes of an octree that halves its cube until each leaf has one point."""
    numpy = import_numpy()
    low = points.min(axis=0)
    edge = (points.max(axis=0) - low).max() * (1 + 1e-9)
    cells = numpy.floor((points - low) / edge * 2.0**20).astype(numpy.int64)
    cells = numpy.unique(cells, axis=0)
    count = 0
    for level in range(20):
        _, n_points = numpy.unique(cells >> (20 - level), axis=0, return_counts=True)
        count += int((n_points > 1).sum())
    return count, len(cells)


@add("C16", "§7: far fewer nodes than a region octree", FULL, "scripts/papers C16",
     "Both without levels of a single child", quick=True)
def _(bench):
    texts = []
    for model in MODELS:
        regions, n_points = count_region_nodes(read_positions(bench, bench.model(model)))
        nodes = bench.run("octree", bench.model(model), "-o", bench.path("nodes.cot"))["inner_nodes"]
        texts.append(f"{model.split('.')[0]} {nodes / n_points:.3f} a point, a region octree {regions / n_points:.3f}")
    return "; ".join(texts)


words("C17", "Fig. 17: boxes of the octree's levels", FULL, "conic render x.cot --show boxes@5:OUT.png",
      "[picture](../pictures/guide/octree.jpg)")


def draw_levels(bench, errors, *options):
    bench.octree("lion.ply")
    for error in errors:
        yield error, bench.render(bench.path("lion.cot"), "--size", "512x512", "--turntable", 12, "--cull", "back",
                                  "--error", error, "--threads", 1, "--repeat", 3, *options)


@add("C18", "Table 2, 512²: Female 53 % of its points at τ 0, 20 % at 0.02 %, 18 % at 0.04 %", PARTLY,
     "conic render lion.cot --cull back --error PX",
     "It does not say of what τ is a per cent: of the picture's width 0.02 % would be 0.10 px, but its Fig. 1 draws more, "
     "113,012 splats, at 1 px. Here 20 % lies near 1.3 px", quick=True)
def _(bench):
    shares = [f"{error} px {100 * report['splats_drawn'] / 341989:.1f} %"
              for error, report in draw_levels(bench, (0, 0.1, 0.5, 1, 2, 4))]
    return "lion: " + ", ".join(shares)


@add("C19", "Table 2: 1.1–4.7 M splats/s with LOD, which is 32–72 % of the frame", FULL, "conic render lion.cot --error PX --threads 1")
def _(bench):
    rates = []
    for error, report in draw_levels(bench, (0.1, 1, 4)):
        ms = report["ms"]
        rates.append(f"{error} px {report['splats_in'] / ms['frame'] / 1e3:.1f} M/s, LOD {100 * ms['lod'] / ms['frame']:.0f} %")
    return "one thread: " + "; ".join(rates)


@add("C20", "Fig. 1: 37.3 % of the splats at τ 1 px look like all", FULL, "conic render lion.cot --error 1", quick=True)
def _(bench):
    bench.octree("lion.ply")
    words_of_both = ("--size", "512x512", "--shade", "none")
    bench.render(bench.path("lion.cot"), *words_of_both, out="whole.pfm")
    report = bench.render(bench.path("lion.cot"), *words_of_both, "--error", 1, out="near.pfm")
    return f"lion {100 * report['splats_in'] / 341989:.1f} %, {bench.decibels('whole.pfm', 'near.pfm'):.1f} dB"


def blended(bench, file, *options):
    bench.render(file, "--size", "1280x1024", "--aov", "count", *options, out="count.pfm")
    counts = read_floats(bench.path("count.pfm"))
    return f"{counts[counts > 0].mean():.1f}"


@add("C21", "Fig. 18, 1280×1024, τ 0.02 %: few splats overlap, mostly 1 is blended", PARTLY,
     "conic render lion.cot --aov count --error PX --prefilter H",
     "Outlines without holes lie five deep, and the prefilter widens each by 1.5 px: "
     "[why](../notes/kernels.md#what-a-pixel-blends)", quick=True)
def _(bench):
    bench.octree("lion.ply")
    file = bench.path("lion.cot")
    texts = [f"{error} px {blended(bench, file, '--error', error)} (no prefilter "
             f"{blended(bench, file, '--error', error, '--prefilter', 0)})" for error in (0, 0.2, 1, 4)]
    return "blended a pixel: lion at " + "; ".join(texts)


words("C22", "§8: no popping and no aliasing in motion", FULL, "test_octree_pictures",
      "Moving in at τ 1 px, frames differ 0.99–1.00 times as much as those of all splats")
words("C23", "Future: transparency", FULL, "conic render --transparency", "[Exact, by sorted layers](transparency.md)")
words("C24", "Future: visibility and blending in a single pass", PARTLY, "conic bench",
      "Set-up is one pass; each tile is visited twice, while it is in the cache")
words("C25", "Future: parameters of the kernel by themselves", ABSENT, "conic render --kernel",
      "No rule by density is nearest everywhere: what is on a surface decides ([measured](../notes/kernels.md#by-density))")
DEPARTURES = [
    "Covariances are about each node's mean, not the world's origin.",
    "A node's error is how far its ellipse stands from its leaves, not its size; tilt has a weight of its own.",
    "Kernels fall to 0 at 1.5, as the text asks for; the printed Eq. 10 does not ([errata](../notes/errata.md)).",
]
