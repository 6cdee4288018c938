"""Ends conic at random moments: `kills.py CONIC [COUNT]`. Each command writes over what is there already.

Afterwards the output is what it was or what it is to be, whole; no input has changed; and after SIGTERM, SIGINT or
SIGHUP nothing else lies beside it. Prints a table of what came of it, and exits 1 where anything was otherwise."""
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

CONIC = os.path.abspath(sys.argv[1])
COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 200
SIGNALS = [signal.SIGKILL, signal.SIGTERM, signal.SIGTERM, signal.SIGKILL, signal.SIGINT, signal.SIGHUP]
INPUTS = {"s.ply": ["make", "knot", "-n", "150k"], "m.ply": ["make", "terrain", "-n", "40k"]}
COMMANDS = {
    "render": (["render", "--plain", "s.ply", "--size", "900x700", "-o"], "out/a.exr"),
    "render png": (["render", "--plain", "s.ply", "--size", "1500x1500", "-o"], "out/a.png"),
    "octree": (["octree", "s.ply", "-o"], "out/a.cot"),
    "layer": (["layer", "s.ply", "--memory", "64", "-o"], "out/a.lpc"),
    "prepare": (["prepare", "s.ply", "-o"], "out/a.ply"),
    "in place": (["prepare", "out/b.ply", "--in-place"], None),
    "mls": (["mls", "project", "m.ply", "-o"], "out/c.ply"),
    "make": (["make", "sphere", "-n", "1M", "-o"], "out/d.ply"),
    "turntable": (["render", "--plain", "m.ply", "--turntable", "2", "--size", "400x400", "-o", "out/t_%d.exr"], None),
}  # and the output, where it is the last word


def content(path):
    try:
        with open(path, "rb") as file:
            return file.read()
    except FileNotFoundError:
        return None


def listing():
    return {name: content(os.path.join("out", name)) for name in os.listdir("out")}


def restore(files):
    for name in os.listdir("out"):
        if name not in files:
            os.unlink(os.path.join("out", name))
    for name, kept in files.items():
        if content(os.path.join("out", name)) != kept:
            with open(os.path.join("out", name), "wb") as file:
                file.write(kept)


def main():
    failures, counts, left_behind = 0, {}, 0
    chance = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.mkdir("out")
        for name, arguments in INPUTS.items():
            subprocess.run([CONIC] + arguments + ["-o", name], check=True, capture_output=True)
        inputs = {name: content(name) for name in INPUTS}
        works = {}
        for name, (arguments, output) in COMMANDS.items():
            before = {} if output is None else {os.path.basename(output): b"what was there before\n"}
            if name == "in place":
                before = {"b.ply": inputs["s.ply"]}
            if name == "turntable":
                before = {"t_1.exr": b"old\n", "t_2.exr": b"old\n"}
            restore(before)
            command = [CONIC] + arguments + ([output] if output else [])
            begun = time.monotonic()
            done = subprocess.run(command, capture_output=True)
            if done.returncode:
                sys.exit(f"{name}: {done.stderr.decode()}")
            works[name] = (command, before, listing(), time.monotonic() - begun)
        for i in range(COUNT):
            name = list(works)[i % len(works)]
            how = SIGNALS[i // len(works) % len(SIGNALS)]
            command, before, after, seconds = works[name]
            restore(before)
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            moment = chance.random() * 1.1 * seconds
            time.sleep(moment)
            process.send_signal(how)
            process.communicate(timeout=120)
            code, now, wrong = process.returncode, listing(), []
            for file, old in before.items():
                if now.pop(file, None) not in (old, after[file]):
                    wrong.append(f"{file} is neither what it was nor what it is to be")
            for file, made in after.items():
                if now.pop(file, made) != made:
                    wrong.append(f"{file} is not whole")
            left_behind += bool(now)
            if now and (how != signal.SIGKILL or not all(file.startswith(".") for file in now)):
                wrong.append(f"it leaves {sorted(now)}")
            wrong += [f"{file} has changed" for file, old in inputs.items() if content(file) != old]
            if code not in (0, -how, 128 + how):
                wrong.append(f"exit code {code}")
            outcome = f"{name}, {how.name}: " + ("done" if code == 0 else "ended")
            counts[outcome] = counts.get(outcome, 0) + 1
            for text in wrong:
                failures += 1
                print(f"BAD {name}, {how.name} after {moment:.3f} s: {text}")
        os.chdir("/")
    for outcome in sorted(counts):
        print(f"    {outcome}: {counts[outcome]}")
    print(f"{COUNT} runs, {failures} things wrong; SIGKILL left hidden files {left_behind} times")
    sys.exit(1 if failures else 0)


main()
