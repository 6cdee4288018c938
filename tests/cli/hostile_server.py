"""A web server with every bad habit, and what conic makes of it: `hostile_server.py CONIC`.

Each case serves a good .lpc badly, from its first, its second or a later answer on, for ever or once. The picture must
be that of the file, or a coarser one that says so (what is late), or an error of one line (what is wrong). Prints a
table: case, options, outcome, seconds, and the line. Exits 1 where an outcome is another than is allowed."""
import concurrent.futures
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

CONIC = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else "conic"
FILE = b""
DEADLINE, LONG_DEADLINE = 1.0, 30.0  # a busy machine must not make late what is wrong
TAG = '"one"'

# What comes of a habit: late (not there in time; a later picture is coarser), wrong (refused), good (does no harm), or
# either of the first two.
LATE, WRONG, GOOD, EITHER = "late", "wrong", "good", "either"


class Answer:
    """One request, and the ways to answer it."""

    def __init__(self, case, link, path, file, first, last, is_whole):
        self.case, self.link, self.path, self.file = case, link, path, file
        self.first, self.last, self.is_whole = first, last, is_whole  # no range was asked for
        self.body = file[first:last + 1]

    def send(self, data):
        self.link.sendall(data if isinstance(data, bytes) else data.encode())

    def head(self, status=None, version="1.1", length=None, tag=TAG, span=None, more=""):
        status = status or ("200 OK" if self.is_whole else "206 Partial Content")
        span = span or ("none" if self.is_whole else f"bytes {self.first}-{self.last}/{len(self.file)}")
        lines = [f"HTTP/{version} {status}"]
        lines += [f"Content-Length: {len(self.body) if length is None else length}"] if length != "" else []
        lines += [f"Content-Range: {span}"] if span != "none" else []
        lines += [f"ETag: {tag}"] if tag else []
        return "\r\n".join(lines) + "\r\n" + more + "\r\n"

    def good(self):
        self.send(self.head())
        self.send(self.body)
        return True

    def hang(self):
        self.link.settimeout(None)
        while self.link.recv(4096):
            pass
        return False

    def repeat(self, data, pause=0.0):
        while True:
            self.send(data)
            time.sleep(pause)


def accept_hang(a):
    return a.hang()


def status_hang(a):
    a.send("HTTP/1.1 206 Par")
    return a.hang()


def head_hang(a):
    a.send(a.head()[:60])
    return a.hang()


def body_hang(a):
    a.send(a.head())
    return a.hang()


def half_hang(a):
    a.send(a.head())
    a.send(a.body[:len(a.body) // 2])
    return a.hang()


def slow(a):  # 1.5 KB/s
    a.send(a.head())
    for i in range(0, len(a.body), 150):
        a.send(a.body[i:i + 150])
        time.sleep(0.1)
    return True


def close_at_once(a):
    return False


def reset(a):
    a.link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    return False


def half_close(a):
    a.send(a.head())
    a.send(a.body[:len(a.body) // 2])
    return False


def busy(a):
    a.send("HTTP/1.1 503 Busy\r\nContent-Length: 0\r\n\r\n")
    return True


def broken(a):
    a.send("HTTP/1.1 500 No\r\nContent-Length: 2\r\n\r\nno")
    return True


def too_many(a):
    a.send("HTTP/1.1 429 Wait\r\nRetry-After: 9999\r\nContent-Length: 0\r\n\r\n")
    return True


def chunk_hang(a):
    a.send(a.head(length="", more="Transfer-Encoding: chunked\r\n"))
    a.send("10\r\n" + "x" * 5)
    return a.hang()


def chunk_name_endless(a):
    a.send(a.head(length="", more="Transfer-Encoding: chunked\r\n"))
    return a.repeat("10;" + "x" * 100, 0.01)


def trailers_endless(a):
    a.send(a.head(length="", more="Transfer-Encoding: chunked\r\n"))
    a.send(b"%x\r\n" % len(a.body) + a.body + b"\r\n0\r\n")
    return a.repeat("X-More: yes\r\n" * 50)


def length_less(a):
    a.send(a.head(length=len(a.body) // 2))
    a.send(a.body[:len(a.body) // 2])
    return True


def length_more(a):
    a.send(a.head(length=len(a.body) + 100))
    a.send(a.body + b"x" * 100)
    return True


def length_none_more(a):
    a.send(a.head(length="", more="Connection: close\r\n"))
    a.send(a.body + b"x" * 100)
    return False


def length_none_endless(a):
    a.send(a.head(length="", more="Connection: close\r\n"))
    a.send(a.body)
    return a.repeat("more" * 1000)


def length_huge(a):
    a.send(a.head(length=1 << 62))
    return a.repeat("more" * 1000)


def length_negative(a):
    a.send(a.head(length=-5))
    a.send(a.body)
    return True


def excess(a):
    a.send(a.head())
    a.send(a.body + b"x" * 1000)
    return True


def excess_later(a):
    a.send(a.head())
    a.send(a.body)
    time.sleep(0.02)
    a.send(b"\x01\x02 garbage\n" * 100)
    return True


def headers_endless(a):
    a.send("HTTP/1.1 206 Partial Content\r\n")
    return a.repeat("X-More: yes\r\n" * 50)


def header_endless(a):
    a.send("HTTP/1.1 206 Partial Content\r\nX-More: ")
    return a.repeat("y" * 1000)


def status_endless(a):
    a.send("HTTP/1.1 206 ")
    return a.repeat("y" * 1000)


def continue_endless(a):
    return a.repeat("HTTP/1.1 100 Continue\r\n\r\n" * 20)


def range_shifted(a):
    a.send(a.head(span=f"bytes {a.first + 1}-{a.last + 1}/{len(a.file)}"))
    a.send(a.body)
    return True


def range_part(a):
    a.body = a.body[:len(a.body) // 2]
    a.send(a.head(span=f"bytes {a.first}-{a.first + len(a.body) - 1}/{len(a.file)}"))
    a.send(a.body)
    return True


def range_none(a):
    a.send(a.head(span="none"))
    a.send(a.body)
    return True


def range_garbage(a):
    a.send(a.head(span="bytes 0-99999999999999999999999/5"))
    a.send(a.body)
    return True


def range_multipart(a):
    part = b"--x\r\nContent-Range: bytes 0-9/100\r\n\r\n" + a.body + b"\r\n--x--\r\n"
    a.send(a.head(span="none", length=len(part), more="Content-Type: multipart/byteranges; boundary=x\r\n"))
    a.send(part)
    return True


def size_other(a):
    a.send(a.head(span=f"bytes {a.first}-{a.last}/{len(a.file) + 1}"))
    a.send(a.body)
    return True


def size_huge(a):
    a.send(a.head(span=f"bytes {a.first}-{a.last}/18446744073709551615"))
    a.send(a.body)
    return True


def tag_other(a):
    a.send(a.head(tag='"two"'))
    a.send(a.body)
    return True


def body_empty(a):
    a.send(a.head(length=0))
    return True


def no_content(a):
    a.send("HTTP/1.1 204 Nothing\r\n\r\n")
    return True


def status(number):
    def answer(a):
        a.send(f"HTTP/1.1 {number} No\r\nContent-Length: 2\r\n\r\nno")
        return True

    return answer


def whole(a):
    a.send(f"HTTP/1.1 200 OK\r\nContent-Length: {len(a.file)}\r\n\r\n")
    a.send(a.file)
    return True


def whole_other(a):
    a.send(f"HTTP/1.1 200 OK\r\nContent-Length: {len(a.file)}\r\n\r\n")
    a.send(b"\0" * len(a.file))
    return True


def whole_endless(a):
    a.send("HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n")
    return a.repeat("more" * 100000)


def redirect_loop(a):
    a.send(f"HTTP/1.1 302 Found\r\nLocation: {a.path}?again\r\nContent-Length: 0\r\n\r\n")
    return True


def redirect_file(a):
    a.send("HTTP/1.1 302 Found\r\nLocation: file:///etc/passwd\r\nContent-Length: 0\r\n\r\n")
    return True


def redirect_nowhere(a):
    a.send("HTTP/1.1 302 Found\r\nContent-Length: 0\r\n\r\n")
    return True


def packed(a):
    a.send(a.head(more="Content-Encoding: gzip\r\n"))
    a.send(a.body)
    return True


def garbage(a):
    a.send(b"\x01\xff\x00 garbage\n" * 100)
    return False


def no_http(a):
    a.send(a.body)
    return False


def chunk_bad(a):
    a.send(a.head(length="", more="Transfer-Encoding: chunked\r\n"))
    a.send("zz\r\nabc\r\n")
    return False


def flip(place):
    """A byte of the file that is wrong: a number is its place, a function finds it in an answer."""

    def answer(a):
        at = (place(a) if callable(place) else place) - a.first
        if 0 <= at < len(a.body):
            a.case.n_flips += 1
            a.body = a.body[:at] + bytes([a.body[at] ^ 0x40]) + a.body[at + 1:]
        return a.good()

    return answer


def old_http(a):
    a.send(a.head(version="1.0", length="", more="Connection: close\r\n"))
    a.send(a.body)
    return False


def chunked(a):
    a.send(a.head(length="", more="Transfer-Encoding: chunked\r\n"))
    for i in range(0, len(a.body), 7001):
        part = a.body[i:i + 7001]
        a.send(b"%x\r\n" % len(part) + part + b"\r\n")
    a.send("0\r\n\r\n")
    return True


def bytewise(a):
    text = a.head().encode()
    for i in range(len(text)):
        a.send(text[i:i + 1])
    a.send(a.body)
    return True


def redirected(a):
    if not a.is_query:
        a.send(f"HTTP/1.1 307 There\r\nLocation: {a.path}?there\r\nContent-Length: 0\r\n\r\n")
        return True
    return a.good()


def no_tag(a):
    a.send(a.head(tag=None))
    a.send(a.body)
    return True


def close_after(a):
    a.send(a.head(more="Connection: close\r\n"))
    a.send(a.body)
    return False


HABITS = {
    LATE: [accept_hang, status_hang, head_hang, body_hang, half_hang, slow, close_at_once, reset, half_close, busy,
           broken, too_many, chunk_hang, chunk_name_endless],
    WRONG: [length_less, length_more, length_none_more, length_none_endless, length_huge, headers_endless,
            header_endless, continue_endless, range_shifted, range_part, range_none, range_garbage, range_multipart,
            size_other, size_huge, tag_other, body_empty, no_content, status(404), status(403), status(410),
            status(416), whole_other, redirect_loop, redirect_file, redirect_nowhere, packed, garbage, no_http,
            chunk_bad],
    EITHER: [length_negative, status_endless, trailers_endless, whole, whole_endless, excess, excess_later],
    GOOD: [old_http, chunked, bytewise, redirected, no_tag, close_after],
}


class Case:
    def __init__(self, name, kind, answer, stage, n_bad, options):
        self.name, self.kind, self.answer, self.stage, self.n_bad = name, kind, answer, stage, n_bad
        self.options, self.n_requests, self.n_flips, self.path = options, 0, 0, ""
        self.files = {}
        self.lock = threading.Lock()

    def serve(self, answer):
        with self.lock:
            i = self.n_requests
            self.n_requests += 1
        is_bad = self.stage <= i < self.stage + self.n_bad
        return (self.answer if is_bad else Answer.good)(answer)


class Server:
    def __init__(self):
        self.cases = {}
        self.listener = socket.create_server(("127.0.0.1", 0), backlog=256)
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            link, _ = self.listener.accept()
            link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self.serve, args=(link,), daemon=True).start()

    def serve(self, link):
        try:
            with link:
                received = b""
                while True:
                    while b"\r\n\r\n" not in received:
                        more = link.recv(65536)
                        if not more:
                            return
                        received += more
                    request, received = received.split(b"\r\n\r\n", 1)
                    words = request.decode().split("\r\n")
                    path, *query = words[0].split(" ")[1].split("?")
                    span = next((w.split("=")[1].split("-") for w in words if w.lower().startswith("range:")), None)
                    _, number, name = path.split("/", 2)
                    case = self.cases[number]
                    file = case.files.get(name)
                    if file is None:
                        link.sendall(b"HTTP/1.1 404 No\r\nContent-Length: 0\r\n\r\n")
                        continue
                    first, last = (int(span[0]), int(span[1])) if span else (0, len(file) - 1)
                    answer = Answer(case, link, path, file, first, min(last, len(file) - 1), span is None)
                    answer.is_query = bool(query)
                    if not case.serve(answer):
                        return
        except OSError:
            pass


def list_cases():
    """Every habit from the first answer on, from the second (the index), from the third (the clouds), and the fourth
    (other than the coarsest); what is wrong also once only, and tolerated; flips of bytes all over the file."""
    cases = []
    deadline = ["--deadline", str(LONG_DEADLINE)]

    def add(kind, answer, name, stage, n_bad, options):
        if kind == LATE:
            options = [str(DEADLINE) if option == str(LONG_DEADLINE) else option for option in options]
        text = f"{name} from {stage + 1} on" if n_bad > 1 else f"{name} at {stage + 1}"
        cases.append(Case(text, kind, answer, stage, n_bad, options))

    always = 1 << 30
    for kind, habits in HABITS.items():
        for habit in habits:
            name = habit.__name__
            if name == "answer":
                name = f"status {habit.__closure__[0].cell_contents}"
            for stage in (0, 1, 2, 3):
                add(kind, habit, name, stage, always, deadline)
            if kind == WRONG:
                add(EITHER, habit, name, 3, 1, deadline)
                add(kind, habit, name, 3, always, deadline + ["--tolerate"])
            if kind == GOOD:
                add(kind, habit, name, 0, always, [])
    n_clouds, = struct.unpack_from("<I", FILE, 24)
    index_end = 256 + 112 * n_clouds
    for at in list(range(0, 248, 24)) + [248, 255]:  # the header and its sum
        add(WRONG, flip(at), f"flip of byte {at}, header", 0, always, deadline)
    for at in [256 + 4 * i for i in range(0, 28, 2)] + [index_end // 2, index_end - 1]:
        add(WRONG, flip(at), f"flip of byte {at}, index", 0, always, deadline)
        if at % 5 == 0 or at > 256 + 112:
            add(EITHER, flip(at), f"flip of byte {at}, index", 0 if at < 65536 else 1, 1, deadline)
    for at in [index_end, index_end + 1, index_end + 1000, (index_end + len(FILE)) // 2, len(FILE) - 1]:
        for options in ([], deadline, deadline + ["--tolerate"], ["--tolerate"]):
            add(WRONG, flip(at), f"flip of byte {at}, clouds", 0, always, options)
    add(WRONG, flip(lambda a: a.first), "flip of every answer's first byte", 2, always, deadline)
    add(WRONG, flip(lambda a: a.last), "flip of every answer's last byte", 2, always, deadline)
    add(EITHER, flip(lambda a: a.first), "flip of the first byte", 2, 1, deadline)
    return cases


def run_conic(arguments, folder):
    started = time.monotonic()
    try:
        done = subprocess.run([CONIC] + arguments, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=120)
        code, errors = done.returncode, done.stderr.decode(errors="replace")
    except subprocess.TimeoutExpired:
        code, errors = -999, "conic: error: it hangs"
    return code, errors.strip().split("\n") if errors.strip() else [], time.monotonic() - started


def picture(name, number, folder, options):
    report = f"{number}.json"
    code, lines, seconds = run_conic(["render", "--plain", name, "-o", f"{number}.pfm", "--size", "96x72", "--threads",
                                      "1", "--json", report] + options, folder)
    told = None
    if code == 0:
        with open(os.path.join(folder, report), encoding="utf-8") as file:
            told = json.load(file)
    return code, lines, seconds, told


def judge(case, code, lines, told, good):
    """The outcome, and whether it is allowed."""
    is_tolerated, has_deadline = "--tolerate" in case.options, "--deadline" in case.options
    if code == 0:
        layers = told["layers"]
        if told["hash"] == good["hash"]:
            return "same", case.kind in (GOOD, EITHER, LATE) or layers["clouds_missing"] == 0
        if layers.get("clouds_damaged", 0) > 0:
            is_named = any("warning" in line and ": cloud " in line for line in lines)
            return "tolerated", is_tolerated and is_named and case.kind in (WRONG, EITHER)
        is_told = layers["clouds_missing"] > 0 and any("warning" in line and "missing" in line for line in lines)
        return "coarser", has_deadline and is_told and case.kind in (LATE, EITHER)
    is_one_line = sum(line.startswith("conic: error: ") for line in lines) == 1 and (is_tolerated or len(lines) == 1)
    if code == 3:
        return "refused", is_one_line and case.kind in (WRONG, EITHER)
    if code == 4:
        return "no answer", is_one_line and case.kind in (LATE, EITHER) and (
            case.stage < 2 or "not even the coarsest" in lines[-1] or not has_deadline)
    return f"exit code {code}", False


def main():
    global FILE
    os.environ["no_proxy"] = "127.0.0.1"
    with tempfile.TemporaryDirectory() as folder:
        for arguments in (["make", "knot", "-n", "80k", "-o", "knot.ply"],
                          ["layer", "knot.ply", "-o", "knot.lpc", "--cloud-size", "64"]):
            code, lines, _ = run_conic(arguments, folder)
            if code:
                sys.exit("\n".join(lines))
        with open(os.path.join(folder, "knot.lpc"), "rb") as file:
            FILE = file.read()
        _, _, _, good = picture("knot.lpc", "good", folder, [])
        server, cases, n_wrong, counts, slowest = Server(), list_cases(), 0, {}, 0.0
        for i, case in enumerate(cases):
            case.path, case.files = f"/{i}/knot.lpc", {"knot.lpc": FILE}
            server.cases[str(i)] = case
        with concurrent.futures.ThreadPoolExecutor(6) as pool:
            urls = [f"http://127.0.0.1:{server.port}{case.path}" for case in cases]
            runs = pool.map(lambda i: picture(urls[i], i, folder, cases[i].options), range(len(cases)))
            for case, (code, lines, seconds, told) in zip(cases, runs):
                outcome, is_allowed = judge(case, code, lines, told, good)
                words = (lines[0] if lines else "").split("knot.lpc: ")[-1]
                print(f"{'    ' if is_allowed else 'BAD '}{case.kind:7}{case.name:36}{' '.join(case.options):26}"
                      f"{outcome:11}{seconds:6.2f} s  {words}", flush=True)
                n_wrong += not is_allowed
                counts[outcome] = counts.get(outcome, 0) + 1
                slowest = max(slowest, seconds)
        print(f"{len(cases)} cases, {n_wrong} not as they should be; slowest {slowest:.2f} s; {counts}")
        sys.exit(1 if n_wrong else 0)


if __name__ == "__main__":
    main()
