"""What hostile_server.py does to a .lpc, done to a .chy: `hostile_hybrids.py CONIC [STEP]`, of which every STEP-th case
is run. The picture is that of the file, or there is one line of error: nothing is drawn of what is wrong or late."""
import concurrent.futures
import os
import subprocess
import sys
import tempfile

from hostile_server import EITHER, GOOD, HABITS, LATE, WRONG, Case, Server, flip, picture, run_conic, slow

PATIENCE = ["--timeout", "1"]


def list_cases(size):
    """Every habit from the header, the arrays and the chunks on, or once; and flips of bytes all over the file."""
    cases = []
    for kind, habits in HABITS.items():
        for habit in habits:
            if habit is slow:  # which is waited for, as there is no --deadline
                continue
            name = habit.__name__ if habit.__name__ != "answer" else f"status {habit.__closure__[0].cell_contents}"
            for stage in (0, 1, 2, 3):
                cases.append(Case(f"{name} from {stage + 1} on", kind, habit, stage, 1 << 30, PATIENCE))
            if kind == WRONG:
                cases.append(Case(f"{name} at 4", EITHER, habit, 3, 1, PATIENCE))
    for i in range(96):
        at = i * 5 if i < 52 else 256 + (i - 52) * (size - 256) // 44
        cases.append(Case(f"flip of byte {at}", WRONG, flip(at), 0, 1 << 30, PATIENCE))
        cases.append(Case(f"flip of byte {at} at 2", EITHER, flip(at), 1, 1, PATIENCE))
    return cases


def judge(case, code, lines, told, good):
    n_errors = sum(line.startswith("conic: error: ") for line in lines)
    if code == 0:
        is_harmless = case.kind != WRONG or case.n_flips == 0
        return "same" if told["hash"] == good["hash"] else "another", told["hash"] == good["hash"] and is_harmless
    is_told = n_errors == 1 and len(lines) == 1
    return f"code {code}", is_told and case.kind != GOOD and code in ((4, 3) if case.kind in (LATE, EITHER) else (3, 4))


def main():
    step = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    os.environ["no_proxy"] = "127.0.0.1"
    terrain = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scripts/terrain-mesh")
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "hill.obj"), "w", encoding="utf-8") as file:
            subprocess.run([terrain, "90", "90"], stdout=file, check=True)
        run_conic(["hybrid", "hill.obj", "-o", "hill.chy"], folder)
        with open(os.path.join(folder, "hill.chy"), "rb") as file:
            content = file.read()
        code, lines, _, good = picture("hill.chy", "good", folder, [])
        if code:
            sys.exit("\n".join(lines))
        server, cases = Server(), list_cases(len(content))[::step]
        for i, case in enumerate(cases):
            case.files, server.cases[str(i)] = {"hill.chy": content}, case
        n_wrong, counts, slowest = 0, {}, 0.0
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            runs = pool.map(lambda i: picture(f"http://127.0.0.1:{server.port}/{i}/hill.chy", i, folder,
                                              cases[i].options), range(len(cases)))
            for case, (code, lines, seconds, told) in zip(cases, runs):
                outcome, is_allowed = judge(case, code, lines, told, good)
                print(f"{'    ' if is_allowed else 'BAD '}{case.kind:7}{case.name:34}{outcome:11}{seconds:6.2f} s  "
                      f"{(lines[0] if lines else '')[-110:]}", flush=True)
                n_wrong += not is_allowed
                counts[outcome] = counts.get(outcome, 0) + 1
                slowest = max(slowest, seconds)
    print(f"chy: {len(cases)} cases, {n_wrong} not as they should be; slowest {slowest:.2f} s; {counts}")
    sys.exit(1 if n_wrong else 0)


if __name__ == "__main__":
    main()
