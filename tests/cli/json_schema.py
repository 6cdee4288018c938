"""Holds what the program writes as JSON against docs/reference/json.schema.json, for tests/cli/json.sh.

json_schema.py SCHEMA FOLDER: FOLDER/NAME.json was written by a run and FOLDER/NAME.definition names its definition;
FOLDER/wanted has lines `NAME key key …`, the keys that scripts rely on, with a ? where they may be absent elsewhere;
FOLDER/unseen has patterns of the keys that no run writes.
"""

import copy
import fnmatch
import json
import pathlib
import sys

import jsonschema

# Objects whose keys are names of things: any of them may be absent.
NAMED = {"methods", "hash", "planes", "bound"}


class Check:
    def __init__(self, schema):
        self.schema, self.failures, self.seen = schema, [], set()
        self.validators = {}

    def fail(self, text):
        self.failures.append(text)

    def validator(self, definition):
        if definition not in self.validators:
            root = {"$ref": "#/$defs/" + definition, "$defs": self.schema["$defs"]}
            self.validators[definition] = jsonschema.Draft202012Validator(root)
        return self.validators[definition]

    def accepts(self, definition, value):
        return self.validator(definition).is_valid(value)

    def resolve(self, schema):
        """The schema and those that it refers to."""
        while schema is not None:
            yield schema
            name = schema.get("$ref", "").rpartition("/")[2]
            schema = self.schema["$defs"][name] if name else None

    def mark(self, schema, value, path):
        """Remembers which keys of the schema a value has."""
        for part in self.resolve(schema):
            if "$ref" in part and part["$ref"].startswith("#/$defs/"):
                path = part["$ref"].rpartition("/")[2]
            if isinstance(value, list) and value and "items" in part:
                for item in value:
                    self.mark(part["items"], item, path)
            for key, item in value.items() if isinstance(value, dict) else ():
                if key in part.get("properties", {}):
                    self.seen.add(f"{path}.{key}")
                    self.mark(part["properties"][key], item, f"{path}.{key}")
                elif isinstance(part.get("additionalProperties"), dict):
                    self.mark(part["additionalProperties"], item, path)

    def described(self, schema, path):
        """The schema's own keys: each has a description, and no object lets in what it does not name."""
        for key, part in schema.get("properties", {}).items():
            if set(part) - {"const", "required"}:
                yield f"{path}.{key}"
                if not part.get("description", "").endswith("."):
                    self.fail(f"the schema has no sentence on {path}.{key}")
            yield from self.described(part, f"{path}.{key}")
        if "properties" in schema and schema.get("type") == "object" and schema.get("additionalProperties") is not False:
            self.fail(f"the schema lets unknown keys into {path}")
        for inner in ("items", "additionalProperties"):
            if isinstance(schema.get(inner), dict):
                yield from self.described(schema[inner], path)

    def holds(self, name, definition, value):
        for error in sorted(self.validator(definition).iter_errors(value), key=lambda e: list(e.absolute_path)):
            where = ".".join(map(str, error.absolute_path)) or "the whole"
            self.fail(f"{name}: {where}: {error.message[:300]}")
            return False
        self.mark({"$ref": "#/$defs/" + definition}, value, "")
        return True

    def refuses(self, name, definition, value):
        """That the schema would see a fault: an unknown key in any object, and a wrong type of any key."""
        def faults(part):
            if isinstance(part, list):
                for item in part[:1]:
                    yield from faults(item)
            elif isinstance(part, dict):
                part["unheard_of"] = 1
                yield "unheard_of"
                del part["unheard_of"]
                for key, item in list(part.items()):
                    part[key] = [] if isinstance(item, dict) else {}
                    yield key
                    part[key] = item
                    yield from faults(item)

        wrong = copy.deepcopy(value)
        for key in faults(wrong):
            if self.accepts(definition, wrong):
                self.fail(f"{name}: a fault in {key} goes unseen")

    def adds_up(self, name, value):
        """That the times of a run are all of it."""
        def holds(times, whole, parts):
            if abs(sum(times[part] for part in parts) - times[whole]) > 1e-6 * times[whole]:
                self.fail(f"{name}: the times do not add up to {whole}: {times}")

        if "seconds" in value and isinstance(value["seconds"], dict):
            inside = {"cluster", "sample", "simplify"}  # of the work
            holds(value["seconds"], "total", set(value["seconds"]) - inside - {"total"})
        if "draw" in value.get("ms", {}):
            of_frame = {"lod", "setup", "bin", "visibility", "accumulate", "resolve", "frame_other"}
            holds(value["ms"], "frame", of_frame)
            holds(value["ms"], "total", set(value["ms"]) - of_frame - {"frame", "total"})

    def wants(self, name, definition, value, keys):
        """The keys that scripts rely on are there, and the schema says that they are."""
        for path in keys:
            may_be_absent = path.endswith("?")
            *folders, key = path.rstrip("?").split(".")
            without = copy.deepcopy(value)
            part = without
            for folder in folders:
                part = part.get(folder, {})
            if key not in part:
                self.fail(f"{name}: no {path}")
                continue
            del part[key]
            if not (may_be_absent or set(folders) & NAMED) and self.accepts(definition, without):
                self.fail(f"{name}: {path} could be missing")


def main(schema_path, folder):
    schema = json.loads(pathlib.Path(schema_path).read_text(encoding="utf-8"))
    folder = pathlib.Path(folder)
    jsonschema.Draft202012Validator.check_schema(schema)
    check = Check(schema)
    known = {key for name, part in schema["$defs"].items() for key in check.described(part, name)}
    wanted = dict(line.split(" ", 1) for line in (folder / "wanted").read_text().splitlines())
    for file in sorted(folder.glob("*.definition")):
        name, definition = file.stem, file.read_text().strip()
        value = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        keys = wanted.pop(name, "").split()
        if check.holds(name, definition, value):
            check.adds_up(name, value)
            check.refuses(name, definition, value)
            check.wants(name, definition, value, keys)
    for name in wanted:
        check.fail(f"{name} was not run")
    unseen = (folder / "unseen").read_text().split()
    for key in sorted(known - check.seen) if not check.failures else ():
        if not any(fnmatch.fnmatch(key, pattern) for pattern in unseen):
            check.fail(f"no run writes {key}, which the schema describes")
    for text in check.failures:
        print("FAILED:", text)
    return 1 if check.failures else 0


sys.exit(main(*sys.argv[1:]))
