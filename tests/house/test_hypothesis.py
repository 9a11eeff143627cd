"""A machine under load is slow: no property test may fail for its time."""

from __future__ import annotations

import ast
from pathlib import Path

TESTS = Path(__file__).parents[1]


def calls(node: ast.FunctionDef | ast.AsyncFunctionDef) -> dict[str, ast.Call]:
    found = {}
    for item in node.decorator_list:
        if isinstance(item, ast.Call) and isinstance(item.func, ast.Name):
            found[item.func.id] = item
    return found


def test_every_property_test_has_no_deadline() -> None:
    faults = []
    for path in sorted(TESTS.rglob("test_*.py")):
        text = path.read_text(encoding="utf-8")
        if "@given" not in text:
            continue
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            decorators = calls(node)
            if "given" not in decorators:
                continue
            keywords = {k.arg: k.value for k in getattr(decorators.get("settings"), "keywords", ())}
            deadline = keywords.get("deadline")
            if not (isinstance(deadline, ast.Constant) and deadline.value is None):
                faults.append(f"{path.name}:{node.name}")
    assert faults == []
