"""Runs the code cells of notebooks, as Jupyter does: what the last expression of a cell gives is shown.

notebooks.py NOTEBOOK…; CONIC_SHOWN names a folder that the pictures are put into."""

import ast
import json
import os
import sys


def run_cell(source, scope, name):
    """What its last expression gives."""
    tree = ast.parse(source, name)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, name, "exec"), scope)  # pylint: disable=exec-used
    return eval(compile(ast.Expression(last.value), name, "eval"), scope) if last else None  # pylint: disable=eval-used


def show(value, path):
    """A picture as PNG, else its words."""
    if hasattr(value, "_repr_png_"):
        png = value._repr_png_()
        assert png[:8] == b"\x89PNG\r\n\x1a\n", path
        if "CONIC_SHOWN" in os.environ:
            with open(path, "wb") as file:
                file.write(png)
    elif value is not None:
        print(repr(value))
    return hasattr(value, "_repr_png_")


def main():
    for notebook in sys.argv[1:]:
        with open(notebook, encoding="utf-8") as file:
            cells = json.load(file)["cells"]
        base, scope, n_pictures = os.path.basename(notebook)[:-6], {"__name__": "__main__"}, 0
        for i, cell in enumerate(cells):
            if cell["cell_type"] != "code":
                continue
            assert not cell["outputs"] and cell["execution_count"] is None, f"{base}: cell {i} holds outputs"
            value = run_cell("".join(cell["source"]), scope, f"{base}[{i}]")
            n_pictures += show(value, os.path.join(os.environ.get("CONIC_SHOWN", "."), f"{base}-{i}.png"))
        assert n_pictures, f"{base}: no picture is shown"
        print(f"{base}: {n_pictures} pictures")


main()
