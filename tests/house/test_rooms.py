"""The size of the rooms: what a newcomer can take in at one look."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MOST_LINES = 400
MOST_FUNCTION_LINES = 60
MOST_LOOSE = 12

Function = ast.FunctionDef | ast.AsyncFunctionDef


def modules() -> list[Path]:
    places = (ROOT / "surveyapp", ROOT / "models", ROOT / "bench", ROOT / "scripts")
    return [path for place in places for path in sorted(place.rglob("*.py"))]


def functions(path: Path) -> Iterator[tuple[str, Function]]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, Function):
            yield f"{path.relative_to(ROOT)}:{node.lineno} {node.name}", node


def lines_without_docstring(node: Function) -> int:
    assert node.end_lineno is not None
    whole = node.end_lineno - node.lineno + 1
    first = node.body[0]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
        assert first.end_lineno is not None
        whole -= first.end_lineno - first.lineno + 1
    return whole


def test_no_module_is_longer_than_a_room() -> None:
    long = {
        str(path.relative_to(ROOT)): count
        for path in modules()
        if (count := len(path.read_text(encoding="utf-8").splitlines())) > MOST_LINES
    }
    assert long == {}


def test_no_function_is_longer_than_a_page() -> None:
    long = {
        name: count
        for path in modules()
        for name, node in functions(path)
        if (count := lines_without_docstring(node)) > MOST_FUNCTION_LINES
    }
    assert long == {}


def test_core_has_few_loose_modules() -> None:
    loose = [path.name for path in (ROOT / "surveyapp" / "core").glob("*.py")]
    assert len(loose) <= MOST_LOOSE, loose
