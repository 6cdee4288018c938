"""`slow_server.py FOLDER BYTES`: a web server of ranges, all of whose answers share one link of so many bytes a second.
Prints its port."""
import http.server
import os
import re
import sys
import threading
import time

folder, rate = sys.argv[1], float(sys.argv[2])
lock, free_at = threading.Lock(), [0.0]


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        with open(os.path.join(folder, os.path.basename(self.path)), "rb") as file:
            data = file.read()
        first, last = map(int, re.match(r"bytes=(\d+)-(\d+)", self.headers["Range"]).groups())
        body = data[first:last + 1]
        self.send_response(206)
        self.send_header("Content-Range", f"bytes {first}-{first + len(body) - 1}/{len(data)}")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        for i in range(0, len(body), 2048):
            with lock:
                free_at[0] = max(free_at[0], time.monotonic()) + len(body[i:i + 2048]) / rate
                wait = free_at[0] - time.monotonic()
            time.sleep(max(wait, 0.0))
            try:
                self.wfile.write(body[i:i + 2048])
            except OSError:
                return


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
server.daemon_threads = True
print(server.server_address[1], flush=True)
server.serve_forever()
