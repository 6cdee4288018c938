"""The page that scripts/papers writes: a table for each paper."""

import re
from dataclasses import dataclass
from typing import Callable, Optional

FULL, PARTLY, ABSENT, OTHER = "full", "partly", "absent", "other"


@dataclass
class Row:
    name: str  # C1: the first row of Confetti
    claim: str  # where it stands, what it claims, and the paper's number
    state: str  # FULL, PARTLY, ABSENT; OTHER where conic does something else on purpose
    command: str = ""  # what shows it
    why: str = ""  # where and why it is not the same
    measure: Optional[Callable] = None  # of a Workbench: the text of conic's number
    is_quick: bool = False


class Rows(list):
    """The rows of a paper; `add` decorates what measures one."""

    def words(self, name, claim, state, command="", why=""):
        self.append(Row(name, claim, state, command, why))

    def add(self, name, claim, state, command="", why="", quick=False):
        def keep(measure):
            self.append(Row(name, claim, state, command, why, measure, quick))
            return measure
        return keep


def read_measured(page):
    """What an earlier run measured, by the names of rows."""
    found = {}
    if page.exists():
        for line in page.read_text(encoding="utf-8").splitlines():
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)]
            if len(cells) == 7 and re.fullmatch(r"[CPLSH]\d+", cells[1]):
                found[cells[1]] = cells[3]
    return found


def write_cells(row, measured):
    number = measured.get(row.name, "not measured") if row.measure else ""
    command = ", ".join(f"`{part}`" for part in row.command.split("; ")) if row.command else ""
    last = ". ".join(part for part in (f"**{row.state}**", row.why) if part)
    return f"| {row.name} | {row.claim} | {number} | {command} | {last} |"


HEAD = """# The five papers

*Made by `scripts/papers`: do not edit.* Each table, figure and claim of the papers is a row: what it says, what
conic gives, what shows it, and why it differs. Times are of one machine: only their ratios mean something.
`test_…` are programs of `build/bin`; models are in `../shared/data`. What is wrong in a paper stands in
[errata](../notes/errata.md).

| paper | full | partly | absent | other on purpose |
|---|---|---|---|---|
"""


def count_states(rows):
    return " | ".join(str(sum(row.state == state for row in rows)) for state in (FULL, PARTLY, ABSENT, OTHER))


def write_page(page, papers, measured):
    text = HEAD
    text += "".join(f"| {paper.TITLE} | {count_states(paper.ROWS)} |\n" for paper in papers)
    for paper in papers:
        text += f"\n## {paper.TITLE}\n\n{paper.INTRODUCTION.strip()}\n\n"
        text += "| | the paper | conic | by | |\n|---|---|---|---|---|\n"
        ordered = sorted(paper.ROWS, key=lambda row: int(row.name[1:]))
        text += "".join(write_cells(row, measured) + "\n" for row in ordered)
        text += "\nDepartures:\n\n" + "".join(f"- {line}\n" for line in paper.DEPARTURES)
    page.write_text(text, encoding="utf-8")
