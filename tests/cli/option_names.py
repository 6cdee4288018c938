"""option_names.py SOURCES TABLE.json: every option that a message names is one that conic help shows, of some command;
TABLE.json is what conic help --format json says. Ends with 1 where a message names another."""

import json
import pathlib
import re
import sys

sources, table = pathlib.Path(sys.argv[1]), json.loads(pathlib.Path(sys.argv[2]).read_text())
ROOMS = "core raster lod oracle surface gaussians opencl source lighting accumulation gathering shots judge cli bench".split()
# What is no option of the program's.
OTHERS = {"--help", "--version", "--all", "--format", "--name"}
shown = {name for command in table["commands"] for option in command["options"] for name in (option["name"], option["alias"])
         if name}
old = {option["name"] for command in table["commands"] for option in command["old_spellings"]} - shown


def literals(text):
    """The strings of C's source, those side by side joined, with the lines on which they begin."""
    text = re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m.group()), text, flags=re.S)
    text = re.sub(r'(?m)//(?![^\n]*").*$', "", text)
    one = r'"(?:[^"\\\n]|\\.)*"'
    for match in re.finditer(rf"{one}(?:\s*\\?\s*{one})*", text):
        joined = "".join(part[1:-1] for part in re.findall(one, match.group()))
        yield text.count("\n", 0, match.start()) + 1, joined


wrong = n = 0
for room in ROOMS:
    for path in sorted((sources / room).rglob("*")):
        if path.suffix not in (".c", ".h"):
            continue
        for line, words in literals(path.read_text(encoding="utf-8")):
            for name in re.findall(r"(?<![\w-])--[a-z][a-z0-9]+(?:-[a-z0-9]+)*", words):
                n += 1
                if name not in shown | OTHERS:
                    wrong += 1
                    print(f"{path.relative_to(sources)}:{line}: {name} is "
                          f"{'an old spelling' if name in old else 'no option'}: {words[:100]}")
print(f"{n} names of options in messages, {wrong} wrong")
# That the pattern finds any, and would see an old one.
sys.exit(1 if wrong or n < 200 or not old else 0)
