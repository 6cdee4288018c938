"""Kills ranks of conic-mpi at random moments: `kills.py CONIC_MPI [COUNT [LAUNCHER…]]`, which is mpirun by itself.

However a job ends, it does so soon, tells why, and leaves each picture as it was or whole; beside these lies only what
--resumable keeps. Jobs that keep something are then gone on with, on another number of ranks, to the bits of a run that
nobody stopped. Prints a table of what came of it, and exits 1 where anything was otherwise."""
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

CONIC = os.path.abspath(sys.argv[1])
COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 50
LAUNCHER = sys.argv[3:] or ["mpirun"]
MOST_SECONDS = 30  # that a job lives on
RENDER = ["render", "s.ply", "--plain", "--threads", "1"]
KEEPS = ["--resumable", "--resume"]
FRAMES = ["--turntable", "12", "--size", "200x150"]
JOBS = {
    "frames": (FRAMES + ["-o", "out/f.exr"] + KEEPS + ["out/f.exr"], 3),
    "frames of samples": (["--turntable", "2", "--accumulate", "40", "--size", "120x90", "-o", "out/a.exr"] + KEEPS
                          + ["out/a.exr"], 3),
    "samples": (["--accumulate", "100", "--size", "160x120", "-o", "out/s.exr"] + KEEPS + ["out/s.exr"], 3),
    "windows": (["--samples", "4", "--size", "700x500", "-o", "out/w.exr"], 4),
}  # and on how many ranks


def content(path):
    with open(path, "rb") as file:
        return file.read()


def pictures():
    return {name: content(os.path.join("out", name)) for name in os.listdir("out") if name.endswith(".exr")}


def empty():
    for name in os.listdir("out"):
        os.unlink(os.path.join("out", name))


def command(arguments, n_ranks):
    return LAUNCHER + ["-n", str(n_ranks), CONIC] + RENDER + arguments


def finish(arguments, n_ranks):
    done = subprocess.run(command(arguments, n_ranks), capture_output=True, timeout=600, stdin=subprocess.DEVNULL)
    return done.returncode, done.stderr.decode()


def ranks_below(process):
    """The ranks that a process or one that it started has started."""
    parents = {}
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            about = content(f"/proc/{entry}/stat").decode(errors="replace")
        except OSError:
            continue
        parents[int(entry)] = int(about.rsplit(")", 1)[1].split()[1]), about.split("(", 1)[1].rsplit(")", 1)[0]
    found, below = [], {process}
    while True:
        more = {child for child, (parent, _) in parents.items() if parent in below} - below
        if not more:
            return found
        found += sorted(child for child in more if parents[child][1] == "conic-mpi")
        below |= more


def kill_one(name, arguments, n_ranks, seconds, chance, whole):
    """Returns what came of it, and what was wrong."""
    wrong, begun = [], time.monotonic()
    process = subprocess.Popen(command(arguments, n_ranks), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               stdin=subprocess.DEVNULL)
    time.sleep(chance.random() * seconds)
    ranks = ranks_below(process.pid)
    victim = chance.choice(ranks) if ranks else None
    if victim:
        try:
            os.kill(victim, signal.SIGKILL)
        except ProcessLookupError:
            victim = None
    try:
        told = process.communicate(timeout=MOST_SECONDS)[1].decode()
    except subprocess.TimeoutExpired:
        process.kill()
        return "hung", [f"still runs {MOST_SECONDS} s after a rank was killed"]
    ended = time.monotonic()
    while ranks_below(1) and [rank for rank in ranks if os.path.exists(f"/proc/{rank}")]:
        if time.monotonic() > ended + 5:
            wrong.append("ranks live on")
            break
        time.sleep(0.05)
    if process.returncode and not told.strip():
        wrong.append("it tells nothing")
    for file, bytes_now in pictures().items():
        if not file.startswith(".") and bytes_now != whole.get(file):
            wrong.append(f"{file} is not whole")
    kept = {file for file in os.listdir("out") if not file.endswith(".exr") or file.startswith(".")}
    unknown = {file for file in kept if not file.endswith((".frames", ".sums"))}
    if not victim or process.returncode == 0:
        outcome = "done before" if process.returncode == 0 else "ended without"
    else:
        outcome = f"ended by {'rank' if name else ''} killed, within {ended - begun:.0f} s"
        outcome = "killed"
    if process.returncode and not victim:
        wrong.append(f"exit code {process.returncode} without a kill: {told[-300:]}")
    return outcome, wrong, unknown


def main():
    failures, counts, left_behind, chance = 0, {}, {}, random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.mkdir("out")
        subprocess.run([CONIC, "make", "knot", "-n", "20k", "-o", "s.ply"], check=True, capture_output=True)
        whole = {}
        for name, (arguments, n_ranks) in JOBS.items():
            begun = time.monotonic()
            code, told = finish(arguments, n_ranks)
            if code:
                sys.exit(f"{name}: {told}")
            whole[name] = pictures(), time.monotonic() - begun
            empty()
            print(f"    {name}: {whole[name][1]:.2f} s", file=sys.stderr)
        for i in range(COUNT):
            name = list(JOBS)[i % len(JOBS)]
            arguments, n_ranks = JOBS[name]
            empty()
            outcome, wrong, *unknown = kill_one(name, arguments, n_ranks, whole[name][1], chance, whole[name][0])
            for file in unknown[0] if unknown else ():
                left_behind[file.rsplit(".", 1)[-1]] = left_behind.get(file.rsplit(".", 1)[-1], 0) + 1
            if "--resume" in arguments and outcome == "killed":
                code, told = finish(arguments, 1 + i % 3)
                if code or {f: b for f, b in pictures().items() if not f.startswith(".")} != whole[name][0]:
                    wrong.append(f"what is gone on with is another picture, exit code {code}: {told[-300:]}")
            counts[f"{name}: {outcome}"] = counts.get(f"{name}: {outcome}", 0) + 1
            for text in wrong:
                failures += 1
                print(f"BAD {name}: {text}")
        os.chdir("/")
    for outcome in sorted(counts):
        print(f"    {outcome}: {counts[outcome]}")
    print(f"{COUNT} runs, {failures} things wrong; files of the killed left: {left_behind or 'none'}")
    sys.exit(1 if failures else 0)


main()
