"""Threads that need different parts of pyproj first do not get halves of it (seen 2026-11-29)."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

from surveyapp.core import geodesy

RACE = """
import sys, threading
sys.setswitchinterval(1e-5)
from surveyapp.core.geodesy import find_projected, open_grid
begin, failed = threading.Barrier(3), []

def run(act):
    begin.wait()
    try:
        act()
    except Exception as error:
        failed.append(error)

acts = (
    lambda: open_grid("EPSG:4546"),
    lambda: find_projected("4546"),
    lambda: find_projected("gauss kruger", coordinates=(431000.0, 3811000.0)),
)
threads = [threading.Thread(target=run, args=(act,)) for act in acts]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(failed)
"""


def test_three_threads_begin_with_different_parts_of_it() -> None:
    """Without the lock it fails in one of five processes; the next test fails always."""
    done = subprocess.run([sys.executable, "-c", RACE], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_whoever_imports_a_part_of_it_takes_the_lock_first() -> None:
    assert geodesy.__file__ is not None
    folder, importers = Path(geodesy.__file__).parent, 0
    for path in folder.glob("*.py"):
        for function in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(function, ast.FunctionDef) or function.name == "load_pyproj":
                continue
            imports = [
                n.lineno
                for n in ast.walk(function)
                if isinstance(n, ast.Import | ast.ImportFrom) and "pyproj" in _imported(n)
            ]
            calls = [
                n.lineno
                for n in ast.walk(function)
                if isinstance(n, ast.Call) and getattr(n.func, "id", "") == "load_pyproj"
            ]
            if imports:
                importers += 1
                assert calls, f"{path.name}, {function.name}"
                assert min(calls) < min(imports)
    assert importers


def _imported(node: ast.Import | ast.ImportFrom) -> str:
    if isinstance(node, ast.ImportFrom):
        return node.module or ""
    return " ".join(alias.name for alias in node.names)
