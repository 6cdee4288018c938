"""Kills ranks of conic-mpi at random moments: `rank_kills.py CONIC_MPI [COUNT [LAUNCHER…]]`, which is mpirun by itself.

However a job ends, it does so soon, tells why, and leaves each file as it was or whole; beside these lies only what
--resumable keeps. Jobs that keep something are then gone on with, by conic or on so many ranks, to the bits of a run that
nobody stopped. Prints a table of what came of it, and exits 1 where anything was otherwise."""
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

CONIC = os.path.abspath(sys.argv[1])
COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 50
LAUNCHER = sys.argv[3:] or ["mpirun"]
MOST_SECONDS = 10  # that ranks live on, and then the launcher
RENDER = ["render", "s.ply", "--plain", "--threads", "1"]
LAYER = ["layer", "l.ply", "--cloud-size", "64", "--threads", "1", "-o", "out/l.lpc"]
KEEPS = ["--resumable", "--resume"]
FRAMES = ["--turntable", "12", "--size", "200x150"]
JOBS = {
    "frames": (RENDER + FRAMES + ["-o", "out/f.exr"] + KEEPS + ["out/f.exr"], 3),
    "branches": (LAYER + KEEPS + ["out/l.lpc"], 3),
    "samples": (RENDER + ["--accumulate", "100", "--size", "160x120", "-o", "out/s.exr"] + KEEPS + ["out/s.exr"], 3),
    "frames of samples": (RENDER + ["--turntable", "2", "--accumulate", "40", "--size", "120x90", "-o", "out/a.exr"] + KEEPS
                          + ["out/a.exr"], 3),
    "strips": (RENDER + ["--size", "900x1600", "--samples", "2", "--memory", "8", "--compression", "none", "-o",
                         "out/p.exr"] + KEEPS + ["out/p.exr"], 3),
    "windows": (RENDER + ["--samples", "4", "--size", "700x500", "-o", "out/w.exr"], 4),
}  # and on how many ranks


def content(path):
    with open(path, "rb") as file:
        return file.read()


def results():
    return {name: content(os.path.join("out", name)) for name in os.listdir("out")
            if not name.startswith(".") and name.endswith((".exr", ".lpc"))}


def empty():
    shutil.rmtree("out")
    os.mkdir("out")


def command(arguments, n_ranks):
    alone = os.path.join(os.path.dirname(CONIC), "conic")
    return ([alone] if n_ranks == 1 else LAUNCHER + ["-n", str(n_ranks), CONIC]) + arguments


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


def is_alive(process):
    try:
        return content(f"/proc/{process}/stat").rsplit(b")", 1)[1].split()[0] != b"Z"
    except OSError:
        return False


def kill_one(arguments, n_ranks, seconds, chance, whole):
    """Returns what came of it, what was wrong, what was left there, and how long it lived on."""
    wrong = []
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
    killed = time.monotonic()
    while any(map(is_alive, ranks)) and time.monotonic() < killed + MOST_SECONDS:
        time.sleep(0.02)
    ended, outcome = time.monotonic(), "ended"
    if any(map(is_alive, ranks)):
        wrong.append(f"ranks live on {MOST_SECONDS} s after one was killed")
    try:
        while not victim and process.poll() is None and (time.monotonic() < killed + MOST_SECONDS
                                                         or ranks_below(process.pid)):
            time.sleep(0.1)  # nobody was there, or no longer: all goes on
        told = b"".join(process.communicate(timeout=MOST_SECONDS)).decode()
    except subprocess.TimeoutExpired:
        process.kill()
        told, outcome = b"".join(process.communicate()).decode(), "ended, but the launcher had to be"
    if process.returncode and outcome == "ended" and not told.strip():
        wrong.append("it tells nothing")
    for file, bytes_now in results().items():
        if bytes_now != whole.get(file):
            wrong.append(f"{file} is not whole")
    unknown = {file for file in os.listdir("out") if file.startswith(".")}
    if process.returncode and outcome == "ended" and not victim:
        wrong.append(f"exit code {process.returncode} without a kill: {told[-300:]}")
    return outcome if process.returncode else "done", wrong, unknown, ended - killed


def main():
    failures, counts, n_left, slowest, chance = 0, {}, 0, 0.0, random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.mkdir("out")
        for file, n in (("s.ply", "20k"), ("l.ply", "100k")):
            subprocess.run([os.path.join(os.path.dirname(CONIC), "conic"), "make", "knot", "-n", n, "-o", file], check=True,
                           capture_output=True)
        whole = {}
        for name, (arguments, _) in list(JOBS.items())[:COUNT]:
            begun = time.monotonic()
            code, told = finish(arguments, 1)
            if code:
                sys.exit(f"{name}: {told}")
            whole[name] = results(), time.monotonic() - begun + 0.5  # until ranks have found each other
            empty()
        for i in range(COUNT):
            name = list(JOBS)[i % len(JOBS)]
            arguments, n_ranks = JOBS[name]
            empty()
            outcome, wrong, left, seconds = kill_one(arguments, n_ranks, whole[name][1], chance, whole[name][0])
            n_left += len(left)
            slowest = max(slowest, seconds if outcome != "done" else 0.0)
            if "--resume" in arguments and outcome != "done":
                code, told = finish(arguments, (1, 1, 3, 2)[i % 4])
                if code or results() != whole[name][0]:
                    wrong.append(f"what is gone on with is another file, exit code {code}: {told[-300:]}")
            counts[f"{name}: {outcome}"] = counts.get(f"{name}: {outcome}", 0) + 1
            for text in wrong:
                failures += 1
                print(f"BAD {name}: {text}")
        os.chdir("/")
    for outcome in sorted(counts):
        print(f"    {outcome}: {counts[outcome]}")
    print(f"{COUNT} runs, {failures} things wrong; all ranks had ended {slowest:.1f} s after a rank was killed, which left "
          f"{n_left} hidden files")
    sys.exit(1 if failures else 0)


main()
