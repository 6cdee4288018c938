"""Gives a page the cases of a conformance suite, takes the pixels that it draws, and judges them.

    python3 server.py [--page FOLDER] [--profile gsplat-1.6] [--level 2] [--port 8137] [--once]

Open http://127.0.0.1:8137/. The page is index.html of FOLDER, or of this folder, where draw.mjs draws in plain
JavaScript: put your own in its place. runner.mjs is the other half. With --once the server ends when the pictures have
been judged, with the exit code of `conic judge`. CONIC names the program; only this machine can reach the server.
"""

import argparse
import functools
import http.server
import json
import os
import struct
import subprocess
import sys
import tempfile
import threading
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
CONIC = os.environ.get("CONIC", "conic")


def npy(pixels, width, height):
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}, 4)}}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + pixels


def png(pixels, width, height):
    """Of 8 bits, and without alpha, which pages multiply in."""
    rows = b"".join(b"\0" + bytes(value for i, value in enumerate(pixels[y * 4 * width:(y + 1) * 4 * width]) if i % 4 < 3)
                    for y in range(height))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


class Work:
    """A suite, and what was drawn of it."""

    def __init__(self, folder, profile, level):
        self.suite, self.pictures = folder + "/suite", folder + "/pictures"
        self.words = ["--profile", profile, "--level", str(level)]
        self.exit_code = 1
        os.mkdir(self.pictures)
        subprocess.run([CONIC, "conformance", self.suite, *self.words, "--quiet"], check=True)
        with open(self.suite + "/cases.tsv", encoding="utf-8") as file:
            lines = [line.rstrip("\n").split("\t") for line in file]
        self.cases = [{"name": name, "scene": "/suite/" + scene, "camera": "/suite/" + camera,
                       "background": [float(word) for word in background.split(",")]}
                      for name, scene, camera, _, background in lines]

    def take(self, name, pixels, width, height):
        """Returns whether it is a picture."""
        if name not in [case["name"] for case in self.cases] or not (0 < width < 65536 and 0 < height < 65536):
            return False
        size, make, ending = {16: (16, npy, "npy"), 4: (4, png, "png")}.get(len(pixels) // (width * height), (0,) * 3)
        if not size or len(pixels) != size * width * height:
            return False
        with open(f"{self.pictures}/{name}.{ending}", "wb") as file:
            file.write(make(pixels, width, height))
        return True

    def judge(self):
        done = subprocess.run([CONIC, "judge", "--suite", self.suite, "--pictures", self.pictures, *self.words],
                              capture_output=True, text=True, check=False)
        self.exit_code = done.returncode
        return {"exitCode": done.returncode, "text": done.stdout + done.stderr}


class Handler(http.server.SimpleHTTPRequestHandler):
    extensions_map = {**http.server.SimpleHTTPRequestHandler.extensions_map, ".mjs": "text/javascript"}

    def __init__(self, *words, work, once, **named):
        self.work, self.once = work, once
        super().__init__(*words, **named)

    def answer(self, value, status=200):
        body = json.dumps(value).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):
        if self.path == "/cases":
            return self.answer(self.work.cases)
        return super().do_GET()

    def translate_path(self, path):
        if path.startswith("/suite/"):
            of_page, self.directory = self.directory, self.work.suite
            found = super().translate_path(path[len("/suite"):])
            self.directory = of_page
            return found
        found = super().translate_path(path)
        return found if os.path.exists(found) else os.path.join(HERE, os.path.basename(found))

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"] or 0))
        if self.path == "/judge":
            self.answer(self.work.judge())
            if self.once:
                threading.Thread(target=self.server.shutdown).start()
            return
        name = self.path[len("/pictures/"):] if self.path.startswith("/pictures/") else ""
        sizes = [int(self.headers.get(key, "0")) for key in ("X-Width", "X-Height")]
        is_taken = self.work.take(name, body, *sizes)
        self.answer({"taken": is_taken}, 200 if is_taken else 400)

    def log_message(self, *_):
        pass


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--page", default=HERE)
    parser.add_argument("--profile", default="gsplat-1.6")
    parser.add_argument("--level", type=int, default=2)
    parser.add_argument("--port", type=int, default=8137, help="0: any; it is printed")
    parser.add_argument("--once", action="store_true")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = Work(folder, given.profile, given.level)
        handler = functools.partial(Handler, work=work, once=given.once, directory=os.path.abspath(given.page))
        with http.server.ThreadingHTTPServer(("127.0.0.1", given.port), handler) as server:
            print(f"http://127.0.0.1:{server.server_address[1]}/", flush=True)
            server.serve_forever()
    return work.exit_code


if __name__ == "__main__":
    sys.exit(main())
