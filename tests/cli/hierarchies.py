"""`hierarchies.py CONIC CLOUDS`: pictures of COPC, EPT and Potree 2 from disk and from the web, by all the ways that must
not change a bit, against the plain file, and of spoiled files. Prints what is not as it should be, and exits 1."""
import json
import os
import random
import shutil
import struct
import sys
import tempfile

import hierarchies_make
import hostile_server
from hostile_server import Answer, Case, GOOD, Server, run_conic

n_wrong = 0


def expect(is_good, what):
    global n_wrong
    if not is_good:
        n_wrong += 1
        print("BAD", what, flush=True)


def draw(folder, name, options, number="p"):
    code, lines, _ = run_conic(["render", "--plain", name, "-o", f"{number}.pfm", "--size", "112x84", "--up", "z",
                                "--json", f"{number}.json"] + options, folder)
    told = None
    if code == 0:
        with open(os.path.join(folder, f"{number}.json"), encoding="utf-8") as file:
            told = json.load(file)
    return code, lines, told


def colors(path):
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        data = file.read()
    return width, height, [data[i:i + 12] for i in range(0, len(data), 12)]


def stands_out(a, b):
    """Pixels that one picture covers and the other does not, nor any of those about."""
    width, height, _ = a
    back = a[2][0]
    n = 0
    for first, second in ((a[2], b[2]), (b[2], a[2])):
        for i, value in enumerate(first):
            x, y = i % width, i // width
            if value != back and all(
                    second[v * width + u] == back
                    for v in range(max(y - 1, 0), min(y + 2, height)) for u in range(max(x - 1, 0), min(x + 2, width))):
                n += 1
    return n


def same_everywhere(server, folder, root, first, number):
    """One hierarchy, `first` in `root`."""
    path = os.path.join(root, first)
    _, lines, good = draw(folder, path, ["--threads", "1"], number)
    expect(good, f"{path}: {lines}")
    if not good:
        return None
    for options in (["--threads", "3", "--memory", "1"], ["--occlusion", "on", "--tile", "16", "--deadline", "60"]):
        _, lines, told = draw(folder, path, options)
        expect(told and told["hash"] == good["hash"], f"{path} {options}: another picture {lines}")
    case = Case("good", GOOD, Answer.good, 0, 0, [])
    case.files = hierarchies_make.files_of(root) if first.endswith(".json") else {first: open(path, "rb").read()}
    server.cases[number] = case
    url = f"http://127.0.0.1:{server.port}/{number}/{first}"
    for options in ([], ["--threads", "1", "--memory", "1"])[:1 if "copc" in root else 2]:
        _, lines, told = draw(folder, url, options)
        expect(told and told["hash"] == good["hash"], f"{url} {options}: another picture {lines}")
    maps = set()
    for options in ([path], [url, "--memory", "1"]):
        code, lines, _ = run_conic(["render", *options, "--camera", "top::32610", "-o", "map.pfm", "-o", "map.tif",
                                    "--json", "map.json"], folder)
        expect(code == 0, f"{options}: no map {lines}")
        with open(os.path.join(folder, "map.json"), encoding="utf-8") as file:
            told = json.load(file)
        maps.add(told["hash"]["rgba"])
        expect(told["pixels_covered"] > 0 and told["top"]["epsg"] == 32610, f"{options}: {told['top']}")
    expect(len(maps) == 1, f"{url}: another map than of the file")
    n_all = case.n_requests
    case.n_requests = 0
    _, lines, told = draw(folder, url, ["--error", "200", "--progressive", "levels"])
    _, _, local = draw(folder, path, ["--error", "200"])
    expect(told and told["hash"] == local["hash"], f"{url}: another coarse picture {lines}")
    if good["layers"]["levels"] > 1:
        expect(told and told["splats_drawn"] < good["splats_drawn"], f"{url}: a coarse picture has all splats")
        expect(case.n_requests <= n_all, f"{url}: a coarse picture takes as many requests")
    if first.endswith(".json"):
        for name in (root, root + "/"):
            _, lines, told = draw(folder, name, [])
            expect(told and told["hash"] == good["hash"], f"{name}: {lines}")
    for budget in (1, 40):
        _, lines, told = draw(folder, path, ["--budget", str(budget)])
        expect(told and 0 < told["splats_in"] <= budget, f"{path}: --budget {budget}: {lines or told['splats_in']}")
    code, lines, _ = run_conic(["info", "--check", path], folder)
    expect(code == 0 and not lines, f"info {path}: {lines}")
    code, lines, _ = draw(folder, path, ["--where", "z > 0"], f"{number}-w")
    expect(code == 3 and "--where" in lines[-1], f"{path}: --where: {code}, {lines}")
    return good


def same_as_plain(folder, path, plain, number):
    """Covers what drawing the plain file covers, to within a pixel."""
    _, _, told = draw(folder, plain, [])
    with open(os.path.join(folder, "camera.json"), "w", encoding="utf-8") as file:
        json.dump(told["camera"], file)
    pictures = []
    for name in (path, plain):
        code, lines, _ = run_conic(["render", "--plain", name, "-o", f"{number}.pfm", "--camera", "camera.json"], folder)
        expect(code == 0, f"{name}: {lines}")
        pictures.append(colors(os.path.join(folder, f"{number}.pfm")))
    n, n_covered = stands_out(*pictures), sum(value != pictures[0][2][0] for value in pictures[0][2])
    print(f"{os.path.basename(path)}: of {n_covered} pixels {n} are not within one of the plain file's picture")
    return n


def spoil(folder, root, first, seed):
    """Bytes that are wrong, files that end early: a picture or one line, never more."""
    chance = random.Random(seed)
    files = hierarchies_make.files_of(root)
    for i in range(5):
        name = chance.choice([n for n in sorted(files) if "source" not in n and "build" not in n])
        data = bytearray(files[name])
        if i % 4 == 0:
            data = data[:chance.randrange(len(data))]
        else:
            for _ in range(chance.choice([1, 1, 4, 64])):
                data[chance.randrange(len(data))] = chance.randrange(256)
        with open(os.path.join(root, name), "wb") as file:
            file.write(data)
        for options in ([], ["--tolerate"]):
            code, lines, _ = draw(folder, os.path.join(root, first), options)
            errors = sum(line.startswith("conic: error: ") for line in lines)
            expect(code in (0, 3) and errors == (code == 3), f"{name} spoiled, {options}: code {code}, {lines}")
        with open(os.path.join(root, name), "wb") as file:
            file.write(files[name])


def leave_out_empty_nodes(folder):
    """Writers such as lasR's name no node that has no points, though it stands above others."""
    root = os.path.join(folder, "rootless")
    shutil.copytree(os.path.join(folder, "ept"), root)
    page, head = os.path.join(root, "ept-hierarchy", "0-0-0-0.json"), os.path.join(root, "ept.json")
    with open(page, encoding="utf-8") as file:
        counts = json.load(file)
    with open(head, encoding="utf-8") as file:
        facts = json.load(file)
    facts["points"] -= counts.pop("0-0-0-0")
    for path, what in ((page, counts), (head, facts)):
        with open(path, "w", encoding="utf-8") as file:
            json.dump(what, file)
    code, lines, _ = run_conic(["info", "rootless/ept.json", "--check", "--json", "rootless.json"], folder)
    with open(os.path.join(folder, "rootless.json"), encoding="utf-8") as file:
        found = json.load(file)
    expect(code == 0 and found["sound"] and found["points"] == facts["points"], f"an EPT without its root: {lines}")


def main():
    clouds = os.path.abspath(sys.argv[2])
    os.environ["no_proxy"] = "127.0.0.1"
    with tempfile.TemporaryDirectory() as folder:
        hierarchies_make.make(folder, 1500)
        server = Server()
        kinds = [k for k in ("potree", "brotli", "ept") if os.path.isdir(os.path.join(folder, k))]
        hashes = set()
        for kind in kinds:
            root, first = os.path.join(folder, kind), "ept.json" if kind == "ept" else "metadata.json"
            good = same_everywhere(server, folder, root, first, kind)
            if not good:
                continue
            hashes.add(json.dumps({k: v for k, v in good["hash"].items() if k != "id"}))
            spoil(folder, root, first, 3)
        expect(len(hashes) == 1, "the kinds give different pictures of the same octree")
        leave_out_empty_nodes(folder)
        code, lines, _ = run_conic(["layer", "ept/ept.json", "-o", "ept.lpc"], folder)
        expect(code == 0, f"layer: {lines}")
        for asked in (["--keep", "all"], ["--where", "z > 0"], ["--color-by", "intensity"]):
            code, lines, _ = run_conic(["layer", "ept/ept.json", "-o", "no.lpc"] + asked, folder)
            expect(code == 3 and asked[0] in lines[-1], f"layer {asked}: {code}, {lines}")
        code, lines, _ = run_conic(["layer", "ept/ept.json", "-o", "ept.lpc", "--color-by", "height"], folder)
        expect(code == 0, f"layer by height: {lines}")
        code, lines, _ = run_conic(["prepare", "potree/metadata.json", "-o", "potree.ply"], folder)
        expect(code == 0, f"prepare: {lines}")
        if os.path.isdir(clouds):
            name = "simple_with_page.copc.laz"
            os.makedirs(os.path.join(folder, "copc"))
            shutil.copyfile(os.path.join(clouds, name), os.path.join(folder, "copc", name))
            os.chmod(os.path.join(folder, "copc", name), 0o600)
            same_everywhere(server, folder, os.path.join(folder, "copc"), name, "copc")
            spoil(folder, os.path.join(folder, "copc"), name, 4)
            same_everywhere(server, folder, os.path.join(clouds, "ept", "1.2-with-color"), "ept.json", "laszip")
            plain = os.path.join(clouds, "ellipsoid.laz")
            for path in ("ellipsoid.copc.laz", "ept/ellipsoid-zstandard/ept.json"):
                expect(same_as_plain(folder, os.path.join(clouds, path), plain, "o") == 0, f"{path}: another outline")
        print(f"{n_wrong} not as they should be")
    sys.exit(1 if n_wrong else 0)


if __name__ == "__main__":
    main()
