"""Computing and Rendering Point Set Surfaces (Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva)."""

from .page import FULL, OTHER, PARTLY, Rows
from .tools import Absent, import_numpy, read_floats, read_positions

TITLE = "Point Set Surfaces"
INTRODUCTION = """
Surfaces by moving least squares: projected, thinned, densified, and drawn as patches.
"""
ROWS = Rows()
add, words = ROWS.add, ROWS.words


words("S1", "§3, Eqs. 1–6: a plane, a polynomial, a search along the normal", FULL, "conic mls project",
      "As corrected ([errata](../notes/errata.md))")


@add("S2", "§3.2: a point that is projected twice stays", FULL, "test_mls_project", quick=True)
def _(bench):
    moves = bench.test("test_mls_project", r"a second time they move by ([\d.e+-]+) h")[0]
    return f"moves by {max(map(float, moves)):.0e} h at most"


words("S3", "Eq. 4, §3.4: Gaussian weights, or compact ones", FULL, "conic mls project --weight compact")
words("S4", "Fig. 4: h small and large", FULL, "conic mls project --h 2x", "[picture](../pictures/surfaces/h.png)")
words("S5", "§3.3: degree 3 or 4; higher ones oscillate", FULL, "conic mls project --degree 3",
      "1 to 4; higher ones are not built")
words("S6", "§3.4: cell by cell, out of core", FULL, "conic mls project --memory 30",
      "13 MiB for a million points, in place of 94")


@add("S7", "§3.4: far samples as one", FULL, "conic mls project --cluster 0.3", quick=True,
     why="Pays only where h is wide; costs 0.0007 h of accuracy")
def _(bench):
    texts = []
    bunny = bench.model("bunny.obj")
    for h in ("2x", "5x", "10x"):
        ms = [bench.run("mls", "project", bunny, "-o", bench.path("p.ply"), "--h", h, "--threads", 1, *more)["seconds"]["work"]
              for more in ((), ("--cluster", 0.3))]
        texts.append(f"h {h}: {ms[0] / ms[1]:.1f} ×")
    return "bunny: " + ", ".join(texts)


words("S8", "§3.4: the plane through the point itself is faster", FULL, "conic mls project --plane fast",
      "1.01 in the place of 0.28 M points/s, of the sums alone")


@add("S9", "§3.5: the bunny, 1,500–3,500 points/s", FULL, "conic mls project bunny.obj --threads 1", quick=True)
def _(bench):
    texts = []
    for plane in ("full", "fast"):
        report = bench.run("mls", "project", bench.model("bunny.obj"), "-o", bench.path("p.ply"), "--plane", plane,
                           "--threads", 1)
        texts.append(f"{plane} {35947 / report['seconds']['work'] / 1e3:.0f} K points/s")
    return ", ".join(texts)


@add("S10", "Eq. 7: the error falls as h^(m+1)", FULL, "test_mls_order", "[chart](../pictures/surfaces/order.svg)")
def _(bench):
    lines = bench.test("test_mls_order", r"gyroid, mls, full, degree (\d): .*: order ([\d.]+)")[0]
    return "gyroid: " + ", ".join(f"degree {degree}: {order}" for degree, order in lines)


def distance_off_torus(bench, n_points, degree):
    """How far patches' depths lie from the torus, in the root of the mean square, where it faces the viewer."""
    numpy = import_numpy()
    torus = bench.once(f"torus{n_points}.ply", lambda out: bench.run("make", "torus", "-n", n_points, "-o", out))
    camera = bench.render(torus, "--aov", "Z", "--projection", "orthographic", "--elevation", 90, "--size", "2000x2000",
                          "--method", f"patch:{degree}", out="depth.pfm")["camera"]
    depth = read_floats(bench.path("depth.pfm")).reshape(2000, 2000)[::-1].astype("f8")
    pose = numpy.array(camera["world_to_camera"])
    rows, columns = numpy.mgrid[0:2000, 0:2000] + 0.5
    seen = numpy.stack([(columns - camera["cx"]) / camera["fx"], (rows - camera["cy"]) / camera["fy"], depth])
    places = numpy.tensordot(pose[:3, :3].T, seen - pose[:3, 3][:, None, None], 1)
    around = numpy.hypot(places[0], places[2]) - 1
    off = numpy.hypot(around, places[1]) - 0.4
    return float(numpy.sqrt((off[(depth > 0) & (abs(around) < 0.25)] ** 2).mean()))


@add("S11", "Eqs. 8–9: the union of patches has the order of the surface", FULL, "conic render --method patch:D",
     "Below 2e-4 the depths' prefilter is what is left")
def _(bench):
    texts = []
    for degree in (1, 2, 3):
        coarse, fine = (distance_off_torus(bench, n, degree) for n in (500, 2000))
        texts.append(f"degree {degree}: {coarse:.1e} → {fine:.1e}, ÷ {coarse / fine:.1f}")
    return "torus, h halved: " + "; ".join(texts)


def variation(positions):
    """How unevenly points lie: the deviation of the distances to their nearest neighbours over the mean."""
    numpy = import_numpy()
    try:
        from scipy.spatial import cKDTree
    except ImportError as error:
        raise Absent("scipy is not there") from error
    distances = cKDTree(positions).query(positions, 2)[0][:, 1]
    distances = distances[distances > 0]
    return float(numpy.std(distances) / numpy.mean(distances))


@add("S12", "Fig. 5: thinned and densified points lie evenly", FULL, "conic mls thin; conic mls densify --spacing 0.5x",
     "Thinning keeps points where the surface bends, so it does not make them even; densifying does")
def _(bench):
    texts = []
    for model in ("nefertiti.obj", "cow.obj"):
        bench.run("mls", "thin", bench.model(model), "-o", bench.path("thin.ply"))
        bench.run("mls", "densify", bench.model(model), "-o", bench.path("dense.ply"), "--spacing", "0.5x")
        found = [variation(read_positions(bench, file)) for file in (bench.model(model), bench.path("thin.ply"),
                                                                     bench.path("dense.ply"))]
        texts.append(f"{model.split('.')[0]} {found[0]:.2f}, thinned {found[1]:.2f}, densified {found[2]:.2f}")
    return "deviation of nearest distances over their mean: " + "; ".join(texts)


words("S13", "§5.1: what contributes least goes first", FULL, "conic mls thin",
      "9.4e-4 off where a random choice is 3.2e-3 off")
words("S14", "Figs. 6–7: coloured by contribution; 37 K → 20 K points", FULL, "conic mls thin --keep contribution",
      "[picture](../pictures/papers/contribution.png): all of nefertiti, and the 10,000 that are left; grey ones cannot be measured")
words("S15", "§5.2, Fig. 8: densifying at the vertices of a Voronoi diagram, 800 → 20,000", OTHER, "conic mls densify",
      "By the largest empty circles that darts find: 12,228 points leave no gap, 4.2e-3 off; "
      "[picture](../pictures/surfaces/densify.png)")
words("S16", "§6.1: a hierarchy of spheres, whose nodes below a pixel are one point", PARTLY, "conic octree",
      "An octree of the same points has the levels: at 128² the lion takes 184 ms as patches, 8 ms by `--error 1`")
words("S17", "§6.2, Figs. 9–10: a patch's extent and spacing, evaluated by forward differences", FULL,
      "conic render --method patch", "Weights of the grid are even to 6 % rms; errors of the differences stay within 2 px "
      "steps")
words("S18", "§6.3: grids of several resolutions, made when wanted", FULL, "conic render --method patch", "3 to 64 rows")
words("S19", "Fig. 11: the bunny as points, splats, a mesh and patches", FULL, "scripts/surface-pictures",
      "[splats](../pictures/surfaces/bunny.png), [patches](../pictures/surfaces/patch.png)")


@add("S20", "Fig. 12: an environment mirrored in 1,000 vertices, as a mesh and as patches", FULL,
     "conic render torus.ply --method patch --sky sky.exr --ao 16 --reflect 1; test_patches",
     "[picture](../pictures/papers/mirror.png): splats and patches. Mirrored, normals are off by 0.6 pixels of a panorama 1,024 "
     "wide by patches, 16 by splats")
def _(bench):
    found = bench.test("test_patches", r"normals off by ([\d.]+) deg rms.*as splats;\n +([\d.]+), ")[0][0]
    return f"torus: normals off by {found[0]}° rms as splats, {found[1]}° as patches"


@add("S21", "§6.4: 1–900 K points, over 5 frames a second", FULL, "conic render --method patch --repeat 3")
def _(bench):
    texts = []
    for count in ("36k", "900k"):
        knot = bench.once(f"knot{count}.ply", lambda out: bench.run("make", "knot", "-n", count, "-o", out))
        ms = bench.render(knot, "--method", "patch", "--size", "512x512", "--repeat", 3)["ms"]["frame"]
        texts.append(f"{count}: {1000 / ms:.0f} a second")
    return ", ".join(texts)


words("S22", "Future: local h, sharp features, a hierarchy from smooth to detailed, topology", PARTLY,
      "conic mls -k K; conic mls --sharp", "The first two. Several `--h` give a sequence from smooth to detailed; topology is not "
      "found: `--hole` is given")
DEPARTURES = [
    "The plane is projected until the point is a fixed point: the printed search does not give one.",
    "Densifying fills the largest empty circles that darts find, not the vertices of a Voronoi diagram.",
]
