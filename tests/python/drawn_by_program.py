"""What the program draws, for comparison."""

import json
import os
import subprocess
import tempfile

PROGRAM = os.environ["CONIC_PROGRAM"]


def conic(*arguments):
    """Runs the program; its JSON."""
    done = subprocess.run([PROGRAM, *map(str, arguments), "--quiet", "--json", "-"], capture_output=True, check=True)
    return json.loads(done.stdout)


def hashes(*arguments):
    """Those of a picture by the program's defaults."""
    with tempfile.TemporaryDirectory() as folder:
        return conic("render", *arguments, "-o", os.path.join(folder, "picture.exr"))["hash"]
