"""Writes a C program that prints the layouts of conic's structs, and compares what it printed with Python's."""

import ctypes
import importlib.util
import sys


def load(source):
    """The layouts alone: neither NumPy nor the library are needed."""
    spec = importlib.util.spec_from_file_location("layouts", f"{source}/python/conic/_layouts.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def lines_of_c(layouts):
    yield "#include <stddef.h>\n#include <stdio.h>\n#include \"cli/host.h\"\n#include \"conic/conic.h\"\n"
    yield "int main(void) {"
    for struct in layouts.STRUCTS:
        name = struct.C_NAME
        yield f'  printf("{name} size %zu\\n", sizeof({name}));'
        for i, (member, _) in enumerate(struct._fields_):
            yield (f'  printf("{name} {i} {member} %zu %zu\\n", offsetof({name}, {member}), '
                   f"sizeof((({name} *)0)->{member}));")
    yield f'  printf("planes %d\\n", CONIC_MAX_PLANES == {layouts.MAX_PLANES});'
    yield f'  printf("attributes %d\\n", CONIC_MAX_ATTRIBUTES == {layouts.MAX_ATTRIBUTES});'
    yield f'  printf("lights %d\\n", CONIC_MAX_LIGHTS == {layouts.MAX_LIGHTS});'
    yield f'  printf("lamps %d\\n", CONIC_MAX_LAMPS == {layouts.MAX_LAMPS});'
    yield f'  printf("methods %d\\n", CONIC_MAX_METHODS == {layouts.MAX_METHODS});'
    yield "  return 0;\n}"


def lines_of_python(layouts):
    for struct in layouts.STRUCTS:
        yield f"{struct.C_NAME} size {ctypes.sizeof(struct)}"
        for i, (member, kind) in enumerate(struct._fields_):
            yield f"{struct.C_NAME} {i} {member} {getattr(struct, member).offset} {ctypes.sizeof(kind)}"
    yield "planes 1"
    yield "attributes 1"
    yield "lights 1"
    yield "lamps 1"
    yield "methods 1"


def main():
    source, action, path = sys.argv[1:]
    layouts = load(source)
    if action == "write":
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines_of_c(layouts)) + "\n")
        return 0
    with open(path, encoding="utf-8") as file:
        wanted = file.read().split("\n")[:-1]
    found = list(lines_of_python(layouts))
    wrong = [(w, f) for w, f in zip(wanted, found) if w != f]
    for w, f in wrong:
        print(f"C has    {w}\nPython   {f}")
    return int(bool(wrong) or len(wanted) != len(found))


sys.exit(main())
