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


def may_be_long(path: Path) -> bool:
    """Whether a function of a module may be too long, by its indentation: parsing costs more."""
    begun: list[tuple[int, int]] = []  # line and indentation of the functions that are open
    lines = path.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines):
        text = line.lstrip()
        indent = len(line) - len(text)
        while begun and text and indent <= begun[-1][1] and not text.startswith((")", '"')):
            if number - begun.pop()[0] > MOST_FUNCTION_LINES:
                return True
        if text.startswith(("def ", "async def ")):
            begun.append((number, indent))
    return any(len(lines) - start > MOST_FUNCTION_LINES for start, _ in begun)


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
        if may_be_long(path)
        for name, node in functions(path)
        if (count := lines_without_docstring(node)) > MOST_FUNCTION_LINES
    }
    assert long == {}


def test_core_has_few_loose_modules() -> None:
    loose = [path.name for path in (ROOT / "surveyapp" / "core").glob("*.py")]
    assert len(loose) <= MOST_LOOSE, loose


def test_a_long_function_is_seen(tmp_path: Path) -> None:
    body = "    x = 1\n" * (MOST_FUNCTION_LINES + 1)
    for number, code in enumerate((f"def f():\n{body}", f"def f():\n{body}\n\ny = 1\n")):
        path = tmp_path / f"{number}.py"
        path.write_text(code, encoding="utf-8")
        assert may_be_long(path)
    short = tmp_path / "short.py"
    short.write_text("def f():\n    pass\n\n\n" * MOST_FUNCTION_LINES, encoding="utf-8")
    assert not may_be_long(short)
