"""Jobs on more ranks: traces, and what the model makes of them where it can be told without it, for
tests/bench/simulate.sh. simulate.py SCRIPT"""
import importlib.machinery
import importlib.util
import json
import sys
import tempfile

loader = importlib.machinery.SourceFileLoader("simulate", sys.argv[1])
simulate = importlib.util.module_from_spec(importlib.util.spec_from_loader("simulate", loader))
loader.exec_module(simulate)
Line = simulate.Line
FAST, SLOW = Line(1e-6, 1e9), Line(1e-3, 1e6)
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print(f"FAILED: {what}")


def check_equal(got, wanted, what):
    check(got == wanted, f"{what}: {got} instead of {wanted}")


def check_near(got, wanted, off, what):
    check(abs(got - wanted) <= off, f"{what}: {got} instead of {wanted}")


def event(name, kind, begun_s, lasted_s, rank, sent_bytes=None, worked_s=None):
    members = {"name": name, "cat": kind, "ph": "X", "ts": 1e6 * begun_s, "dur": 1e6 * lasted_s, "pid": rank, "tid": 0}
    if sent_bytes is not None:
        members["args"] = {"sent_bytes": sent_bytes}
    if worked_s is not None:
        members["tdur"] = 1e6 * worked_s
    return members


def read(events, is_by_processor=False):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump({"displayTimeUnit": "ms", "traceEvents": events}, file)
        file.flush()
        return simulate.read_trace(file.name, is_by_processor)


def refuses(events, is_by_processor=False):
    try:
        read(events, is_by_processor)
    except simulate.WrongTrace:
        return True
    return False


def test_trace():
    """Two ranks, three units, one merging."""
    trace = read([event("scene 0", "open", 1, 2, 0), event("scene 0", "open", 1, 1, 1),
                  event("samples 0", "unit", 3, 0.5, 0, 7), event("samples 1", "unit", 2, 4, 1, 0),
                  event("samples 2", "unit", 4, 0.25, 0), event("swap 0", "join", 6, 5, 1, 100),
                  event("swap 0", "join", 6, 5, 0, 100), event("parts 0", "join", 6, 5, 0),
                  event("sums 1", "join", 6, 3, 0), event("OUT", "write", 9, 2, 0)])
    check_equal((trace.n_ranks, trace.n_units, trace.seconds, trace.open_s), (2, 3, 10.0, 1.5), "a trace")
    check_equal([unit[:2] for unit in trace.units], [(4.0, 0.0), (0.5, 7.0), (0.25, 0.0)], "units as they were begun")
    check_equal((trace.merge_s, trace.merge_bytes, trace.n_merges), (3.0, 200.0, 1.0), "a merging")
    check_equal((trace.write_s, trace.join_s), (2.0, 0.0), "writing, and waiting for parts, which is no joining")


def test_processor_time():
    """A rank that was kept from its core: what it worked is all that counts, and what it waited is no work."""
    events = [event("scene 0", "open", 0, 4, 0, worked_s=1), event("read 9", "stage", 4, 3, 0, worked_s=1),
              event("read 9", "wait", 5, 2, 0, worked_s=0), event("window 0", "unit", 7, 9, 0, worked_s=2)]
    trace = read(events, True)
    check_equal((trace.seconds, trace.open_s, trace.loops.seconds, trace.units[0][0], trace.stages["read"].seconds),
                (16.0, 1.0, 1.0, 2.0, 1.0), "processor time")
    trace = read(events)
    check_equal((trace.open_s, trace.units[0][0]), (4.0, 9.0), "the clock's time")
    check(refuses([event("window 0", "unit", 7, 9, 0)], True), "a trace without processor time is taken")


def test_wrong_events():
    for wrong in ({"cat": "unit", "dur": -1}, {"cat": "unit", "pid": 1e9}, {"cat": "unit", "pid": -1},
                  {"cat": "unit", "args": {"sent_bytes": -1}}, {"cat": "unit", "dur": "1"}, {"cat": 1}, {"dur": True},
                  {"cat": "unit", "dur": float("nan")}, {"args": 3}, {"cat": "open", "dur": 1}):
        check(refuses([wrong]), f"{wrong} is taken for a trace")


def even(n_bytes):
    """96 units of a second each, of so many bytes."""
    return read([event("frame 0", "unit", i, 1, 0, n_bytes) for i in range(96)])


def estimate(trace, n_ranks, times=1, line=FAST):
    e = simulate.schedule(trace, line, n_ranks, times)
    check(e.n_ranks == n_ranks and e.efficiency <= 1.0, f"{n_ranks} ranks have an efficiency of {e.efficiency}")
    return e


def set_units(trace, units):
    trace.units = [(seconds, n_bytes, 0.0) for seconds, n_bytes in units]


def test_units():
    light, heavy = even(0), even(2e8)

    def takes(trace, n_ranks, times, wanted, off, what):
        check_near(estimate(trace, n_ranks, times).seconds, wanted, off, f"{what} on {n_ranks} ranks, {times} times")

    takes(light, 1, 1, 96.0, 1e-3, "light units")
    takes(light, 32, 1, 3.0, 1e-3, "light units")
    takes(light, 64, 1, 2.0, 1e-3, "light units")  # half of the ranks have one unit, the others two
    check_near(estimate(light, 64).lost_s["uneven"], 0.5, 1e-3, "an uneven end")
    takes(light, 64, 10, 15.0, 1e-3, "light units")
    # Rank 0 takes a fifth of a second for each result of others, which go on meanwhile: five keep it busy.
    takes(heavy, 1, 1, 96.0, 1e-3, "heavy units")
    takes(heavy, 2, 1, 96.0 / 1.8, 1.0, "heavy units")
    takes(heavy, 3, 1, 96.0 / 2.6, 1.5, "heavy units")  # and the last ten to others
    takes(heavy, 12, 8, 1.0 + 768.0 * 0.2, 0.8, "heavy units")  # it leaves all to the others,
    check(estimate(heavy, 12, 8).lost_s["first"] > 80.0, "ranks do not wait for rank 0")  # which wait for it
    takes(heavy, 96, 1, 1.0 + 96.0 * 0.2, 1e-2, "heavy units")  # rank 0 has none of its own
    check(estimate(heavy, 96).lost_s["uneven"] > 17.0, "rank 0 is done as soon as the others")
    set_units(heavy, [(1.0, 5e7)] * 80 + [(0.05, 1e6)] * 16)
    check(estimate(heavy, 16).seconds < 6.5, "rank 0 goes on as long as there are units")  # which would take 7 s
    set_units(heavy, [(1.0, 0.0)] * 95 + [(1.0, 2e8)])
    heavy.join_s = 9.6
    takes(heavy, 1, 1, 96.0 + 9.6, 1e-3, "joining")
    takes(heavy, 2, 1, 48.0 + 9.6 + 0.2, 0.1, "joining")  # as long as there are bytes
    light.open_s, light.write_s = 4.0, 1.0
    takes(light, 32, 1, 8.0, 1e-3, "opening and writing")
    takes(light, 32, 10, 4.0 + 30.0 + 10.0, 1e-3, "opening and writing")
    light.n_merges, light.merge_s, light.merge_bytes = 1.0, 0.5, 1e9
    takes(light, 2, 1, 53.0 + 0.5 * 2.5, 1e-3, "merging")
    takes(light, 32, 1, 8.0 + 2.5 * 31.0 / 32.0, 2e-3, "merging")  # the bytes go twice
    takes(light, 32, 10, 4.0 + 30.0 + 1.0 + 2.5 * 31.0 / 32.0, 2e-3, "merging")


def test_layers():
    """Two ranks that built a cloud: what they waited is no work."""
    trace = read([event("inputs 0", "open", 0, 0.1, 0), event("read 0", "stage", 0.1, 5, 0),
                  event("read 0", "stage", 0.1, 7, 1), event("read 0", "wait", 0.1, 2, 1),
                  event("exchange 1000000", "stage", 7, 1, 0, 8e6), event("exchange 1000000", "stage", 7, 1, 1, 8e6),
                  event("grow 1000000", "stage", 8, 40, 0), event("grow 1000000", "stage", 8, 40, 1),
                  event("order 2000", "stage", 48, 0.5, 0)])
    check_equal((trace.job, trace.n_units, trace.n_ranks), (simulate.LAYERS, 2, 2), "a job of building")
    check_equal(trace.stages["read"].seconds, 10.0, "reading")
    check_equal(trace.stages["grow"].number, 2e6, "samples that grow")
    alone, few, many = (estimate(trace, n) for n in (1, 16, 1024))
    check_near(alone.seconds, 90.55, 1e-2, "building alone")  # without an exchange
    check_equal(alone.efficiency, 1.0, "its efficiency")
    check(92.0 / 16.0 + 0.55 < few.seconds < 92.0 / 16.0 + 1.2 and few.efficiency > 0.8, "building on 16 ranks")
    check(many.efficiency < few.efficiency and many.lost_s["first"] == 0.5, "building on 1024 ranks")
    check(estimate(trace, 16, line=SLOW).lost_s["merge"] > few.lost_s["merge"] + 1.0, "a slow line costs nothing")
    large = estimate(trace, 16, 10)
    check_near(large.lost_s["first"], 5.0, 1e-9, "ten times as many nodes")
    check(large.seconds > 9.0 * few.seconds, "ten times as much takes no longer")


def test_loops():
    """Two ranks that do the same for a second, and share loops of 3 s each, of which one waits for a half."""
    trace = read([event("measure 9", "stage", 1, 3, 0, 2e6), event("measure 9", "stage", 1, 3, 1, 1e6),
                  event("measure 9", "wait", 3.5, 0.5, 1), event("prepare 0", "build", 0, 3.5, 1),
                  event("prepare 0", "build", 0, 4, 0)])
    check_equal((trace.job, trace.n_units, len(trace.events), trace.seconds), (simulate.LOOPS, 2, 5, 4.0), "loops")
    check_equal((trace.alone_s, trace.loops.seconds), (1.0, 5.5), "what is done alone, and shared")
    alone = estimate(trace, 1)
    check_equal((alone.seconds, alone.efficiency), (6.5, 1.0), "loops alone")
    # 2 MB, of which half comes to rank 0 first
    check_near(estimate(trace, 2).seconds, 1.0 + 2.75 + 3e-3, 1e-4, "loops on 2 ranks")
    many = estimate(trace, 64, 10)
    check_equal(many.lost_s["open"], 10.0, "what all do")
    check_near(many.seconds, 10.0 + 55.0 / 64.0, 0.05, "loops on 64 ranks")
    check_near(estimate(trace, 2, line=Line(1e-6, 1e6)).lost_s["merge"], 3.0, 1e-3, "what loops bring together")


def test_light():
    """A picture whose light the ranks share is no building; its light is shared like its windows."""
    trace = read([event("direction 9", "stage", 0, 3, 0), event("read 9", "stage", 0, 3, 1),
                  event("window 0", "unit", 3, 1, 0), event("window 1", "unit", 3, 1, 1)])
    check_equal((trace.job, trace.n_units, trace.units[1][0]), (simulate.UNITS, 2, 1.0), "a picture with light")
    check_near(estimate(trace, 2, line=Line(0.0, 1e12)).seconds, 4.0, 1e-4, "light and windows")


for test in (test_trace, test_processor_time, test_wrong_events, test_units, test_layers, test_loops, test_light):
    test()
sys.exit(len(failures) > 0)
