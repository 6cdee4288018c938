"""manuals.py SOURCE holds what conic help has written into this folder against its table of options, and the options that
the docs and the examples name, too. Prints what is wrong; ends with 1 where anything is."""

import json
import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1])
table = json.load(open("table.json"))
wrong = []


def text_of(path):
    return pathlib.Path(path).read_text(encoding="utf-8")


def check(is_right, message):
    if not is_right:
        wrong.append(message)


options = {c["name"]: {n for o in c["options"] for n in (o["name"], o["alias"]) if n} for c in table["commands"]}
every_option = set.union(*options.values())
old = {c["name"]: {o["name"] for o in c["old_spellings"]} for c in table["commands"]}
every_option |= set.union(*old.values())
bash, zsh, fish = (text_of(f"completion.{shell}") for shell in ("bash", "zsh", "fish"))

# Each option, with its value's name and its default, in each form.
for command in table["commands"]:
    name = command["name"]
    help_text = re.sub(r"\s+", " ", text_of(f"help/{name}"))
    page = text_of(f"man1/conic-{name}.1").replace("\\-", "-").replace("\\&", "")
    for font in ("\\fB", "\\fI", "\\fR"):
        page = page.replace(font, "")
    flat_page = re.sub(r"\s+", " ", page)
    in_bash = re.search(rf"^    {name}\)\n      options='([^']*)'", bash, re.M).group(1).split()
    in_zsh = re.search(rf"^  {name}\)\n(.*?)^    ;;$", zsh, re.M | re.S).group(1)
    in_fish = [line for line in fish.splitlines() if f"'__conic_is {name}'" in line]
    check(set(in_bash) == options[name], f"bash: {name}: {set(in_bash) ^ options[name]}")
    for option in command["options"]:
        argument = f" {option['argument']}" if option["argument"] else ""
        both = ", ".join(n for n in (option["name"], option["alias"]) if n)
        check(f" {both}{argument} " in help_text, f"help {name}: no {both}{argument}")
        check(f".TP\n{both}{argument}\n" in page, f"conic-{name}(1): no {both}{argument}")
        check(option["text"] in flat_page, f"conic-{name}(1): no text of {both}")
        if option["default"]:
            check(f"Default: {option['default']}." in flat_page, f"conic-{name}(1): no default of {both}")
            check(f"[{option['default']}]" in help_text, f"help {name}: no default of {both}")
        check(option["group"] and option["group"] in help_text, f"help {name}: no group {option['group']}")
        check((option["argument"] is None) == (option["type"] == "flag"), f"{name}: {both}: no name of its value")
        check(len(option["text"]) > 5, f"{name}: {both} says nothing")
        for word in option.get("words", []):
            check(option["type"] != "choice" or word in flat_page, f"conic-{name}(1): {both}: no word {word}")
        for one in filter(None, (option["name"], option["alias"])):
            check(re.search(rf"'\*?{one}[=+]?\[", in_zsh), f"zsh: {name}: no {one}")
            letters = f" -{'l' if one.startswith('--') else 's'} {one.lstrip('-')} "
            check(any(letters in line for line in in_fish), f"fish: {name}: no {one}")
    check(command["usage"].startswith(f"conic {name}"), f"{name}: its usage is of something else")
    for word in re.findall(r"--?[a-z][a-z0-9-]*", command["usage"]):
        check(word in options[name], f"{name}: its usage has an option {word}")
    for example in command["examples"]:
        check(example.startswith("conic "), f"{name}: an example of something else: {example}")

# What belongs to other programs, where docs speak of them.
others = set(
    """--trace --trace-ranks --mpi
    --build --install --prefix --test-dir --preset --parallel --label-exclude --output-on-failure --version --static
    --cflags --libs --format --fix --check --list --break --all --help
    --manylinux --variable""".split()
)


def check_call(where, call):
    """A call of conic: its options are of this command."""
    words = re.split(r"[\s`\"'()|;]+", call)
    if len(words) < 2 or words[1] not in options:
        return
    for word in words[2:]:
        named = re.match(r"\[?(--?[a-z][a-z0-9-]*)(?![\w,])", word)
        if named and not re.match(r"-[0-9]", word):
            check(named.group(1) in options[words[1]] | old[words[1]], f"{where}: conic {words[1]} has no {named.group(1)}")


for command in table["commands"]:
    for example in command["examples"]:
        for call in example.split("\n"):
            check_call(f"example of {command['name']}", call)

n_named = 0
for page in [source / "README.md", *sorted((source / "docs").rglob("*.md"))]:
    where = page.relative_to(source)
    text = text_of(page)
    if "docs/notes/" in str(where):
        continue
    blocks = re.findall(r"^```.*?\n(.*?)^```", text, re.M | re.S)
    for block in blocks:
        for line in block.replace("\\\n", " ").split("\n"):
            for call in re.findall(r"(?<![\w/-])conic [a-z]+ [^|;&#]*", line):
                check_call(where, call)
    prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for code in re.findall(r"`([^`]*)`", prose):
        code = re.sub(r"\s+", " ", code)
        if code.startswith("conic "):
            check_call(where, code.split(" | ")[0])
        elif not re.match(r"(cmake|ctest|oiiotool|pytest|python|scripts/|apt|pip|mpirun|pkg-config|git|bench/)", code):
            for word in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", code):
                n_named += 1
                check(word in every_option | others, f"{where}: no command has {word}")
check(n_named > 100, f"the docs name only {n_named} options")

print("\n".join(wrong))
sys.exit(1 if wrong else 0)
