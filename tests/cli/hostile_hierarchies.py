"""What hostile_server.py does to a .lpc, done to COPC, EPT and Potree 2: `hostile_hierarchies.py CONIC CLOUDS [STEP]`, of
which every STEP-th case is run. None of them has sums: a byte that is wrong may become another picture, but no crash, no
hang, and no more than one line."""
import concurrent.futures
import json
import os
import sys
import tempfile

import hierarchies_make
import hostile_server
from hostile_server import (DEADLINE, EITHER, GOOD, HABITS, LATE, LONG_DEADLINE, WRONG, Answer, Case, Server, judge,
                            run_conic)

ANY = "any"  # another picture, or refused

# What a whole file cannot do, or does no harm: nothing says which range of it is sent.
OF_RANGES = {"range_shifted", "range_part", "range_none", "range_garbage", "range_multipart", "size_other", "size_huge",
             "tag_other"}
HARMLESS_OF_WHOLE = {"whole"}


def kind_of(kind, habit, is_whole):
    name = habit.__name__
    if not is_whole:
        return kind
    if name in OF_RANGES:
        return None
    return GOOD if name in HARMLESS_OF_WHOLE else EITHER if kind == WRONG else kind


def name_of(habit):
    return habit.__name__ if habit.__name__ != "answer" else f"status {habit.__closure__[0].cell_contents}"


def list_cases(is_whole, stages):
    """`stages` are the first requests of which each reads something else; the last begins with the drawing."""
    cases = []
    deadline = ["--deadline", str(LONG_DEADLINE)]

    def add(kind, habit, stage, n_bad, options):
        options = [str(DEADLINE) if kind == LATE and o == str(LONG_DEADLINE) else o for o in options]
        text = f"{name_of(habit)} {'from' if n_bad > 1 else 'at'} {stage + 1}{' on' if n_bad > 1 else ''}"
        cases.append(Case(text, kind, habit, stage, n_bad, options))

    always = 1 << 30
    for kind, habits in HABITS.items():
        for habit in habits:
            for stage in stages:
                found = kind_of(kind, habit, is_whole and stage > 0)
                if found:
                    add(found, habit, stage, always, deadline)
            found = kind_of(kind, habit, is_whole)
            if found and kind == WRONG:
                add(EITHER, habit, stages[-1], 1, deadline)
                add(found, habit, stages[-1], always, deadline + ["--tolerate"])
    for i in range(48):
        cases.append(Case(f"flip {i}", ANY, flip_some(i), 0, always, deadline + ["--tolerate"] * (i % 2)))
    return cases


def flip_some(i):
    """Of every answer some bytes are wrong, always the same."""

    def answer(a):
        body = bytearray(a.body)
        for k in range(1 + i % 3):
            at = (i * 7919 + k * 104729) % max(len(body), 1)
            if at < len(body):
                body[at] ^= 1 << (i + k) % 8
        a.body = bytes(body)
        return a.good()

    return answer


def picture(url, number, folder, options):
    code, lines, seconds = run_conic(["render", "--plain", url, "-o", f"{number}.pfm", "--size", "64x48", "--up", "z",
                                      "--threads", "1", "--memory", "64", "--json", f"{number}.json"] + options, folder)
    told = None
    if code == 0:
        with open(os.path.join(folder, f"{number}.json"), encoding="utf-8") as file:
            told = json.load(file)
    return code, lines, seconds, told


def judge_kind(case, code, lines, told, good, first_drawn):
    if case.kind == ANY:
        n_errors = sum(line.startswith("conic: error: ") for line in lines)
        return f"code {code}", code in (0, 3, 4) and n_errors == (code != 0)
    outcome, is_allowed = judge(case, code, lines, told, good)
    if outcome == "no answer" and case.stage < first_drawn:
        is_allowed = case.kind in (LATE, EITHER)
    if outcome == "tolerated" and not is_allowed:
        is_allowed = "--tolerate" in case.options and case.kind in (WRONG, EITHER) and any(
            "warning" in line and ": node " in line for line in lines)
    return outcome, is_allowed


def run_kind(name, files, first, stages, folder, step):
    is_whole = first == "ept.json"
    server, cases = Server(), list_cases(is_whole, stages)[::step]
    for i, case in enumerate(cases):
        case.files, server.cases[str(i)] = files, case
    calm = Case("good", GOOD, Answer.good, 0, 0, [])
    calm.files, server.cases["good"] = files, calm
    _, lines, _, good = picture(f"http://127.0.0.1:{server.port}/good/{first}", "good", folder, [])
    if not good:
        sys.exit("\n".join(lines))
    n_wrong, counts, slowest = 0, {}, 0.0
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        urls = [f"http://127.0.0.1:{server.port}/{i}/{first}" for i in range(len(cases))]
        runs = pool.map(lambda i: picture(urls[i], i, folder, cases[i].options), range(len(cases)))
        for case, (code, lines, seconds, told) in zip(cases, runs):
            outcome, is_allowed = judge_kind(case, code, lines, told, good, stages[-1])
            print(f"{'    ' if is_allowed else 'BAD '}{name:7}{case.kind:7}{case.name:34}{' '.join(case.options):26}"
                  f"{outcome:11}{seconds:6.2f} s  {(lines[0] if lines else '')[-110:]}", flush=True)
            n_wrong += not is_allowed
            counts[outcome] = counts.get(outcome, 0) + 1
            slowest = max(slowest, seconds)
    print(f"{name}: {len(cases)} cases, {n_wrong} not as they should be; slowest {slowest:.2f} s; {counts}")
    return n_wrong


def main():
    clouds, step = sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 1
    os.environ["no_proxy"] = "127.0.0.1"
    n_wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        hierarchies_make.make(folder, 6000)
        kinds = [("potree", hierarchies_make.files_of(os.path.join(folder, "potree")), "metadata.json", (0, 1, 2, 3, 4)),
                 ("ept", hierarchies_make.files_of(os.path.join(folder, "ept")), "ept.json", (0, 1, 2, 3, 4, 5))]
        copc = os.path.join(clouds, "ellipsoid.copc.laz")
        if os.path.exists(copc):
            with open(copc, "rb") as file:
                kinds.append(("copc", {"x.copc.laz": file.read()}, "x.copc.laz", (0, 1, 2, 3)))
        for kind in kinds:
            n_wrong += run_kind(*kind, folder, step)
    sys.exit(1 if n_wrong else 0)


if __name__ == "__main__":
    main()
