"""Attaches what conic's judge has found to the report of a failed test: the verdict as a section of it, and the HTML
report and the map as files."""

from __future__ import annotations

import os
import re
import shutil
from typing import Any

import pytest


def pytest_addoption(parser: Any) -> None:
    parser.getgroup("conic").addoption("--conic-reports", metavar="FOLDER", default=None,
                                       help="where conic's reports on pictures that are wrong are put, one folder a "
                                       "test [where the failures name them]")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: Any, call: Any) -> Any:
    outcome = yield
    failure = call.excinfo.value if call.excinfo is not None else None
    if failure is None or type(failure).__name__ != "PictureMismatch":
        return
    report, files = outcome.get_result(), list(failure.files)
    folder = item.config.getoption("--conic-reports")
    if folder:
        place = os.path.join(folder, re.sub(r"[^\w.-]+", "_", item.nodeid))
        os.makedirs(place, exist_ok=True)
        files = [shutil.copy(path, place) for path in files]
    report.sections.append(("conic", "\n".join([str(failure), *files])))
    report.user_properties.extend(("conic", path) for path in files)
    extras = getattr(report, "extras", None)
    html = item.config.pluginmanager.getplugin("html")
    if html is not None and hasattr(html, "extras"):
        report.extras = (extras or []) + [html.extras.url(path, name=os.path.basename(path)) for path in files]
