"""Public functions with numbers say in which unit they are."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = (
    "models/surveyapp_models",
    "surveyapp/domain",
    "surveyapp/core",
    "surveyapp/workflows",
    "surveyapp/api",
)
IN_THE_NAME = re.compile(
    r"_(s|m|mm|km|deg|rad|arcsec|c|k|hz|hpa|v|h|d|days|ppm|percent|div|m2|kg|nm|ut|g|hours|minutes"
    r"|rad_s|deg_s|deg_h|m_s2|m_s)$"
)
IN_THE_TEXT = re.compile(
    r"\[(rad|m|s|arcsec|deg|div|mm|km|Hz|C|V|K|hPa|%|-|h|d|gon|uT|kg|N|unit|1/)[^\]a-z]*[^\]]*\]"
    r"|radians|metres|seconds|degrees|divisions|unit of|one unit|half swings|standard errors"
    r"|sqrt\(r\)|-1\b"
)
NUMBERS = {
    *("probability", "level", "family_level", "quantile", "confidence", "power", "significance"),
    *("false_alarm", "p", "share", "weight", "factor", "ratio", "scale", "strength", "control"),
    *("dof", "dof_numerator", "dof_denominator", "sigma_dof", "relative_rate_sigma", "order"),
    *("x", "a", "b", "q", "r", "value", "default", "largest", "sign", "threshold"),
}
"""Without a unit: probabilities, shares, factors, counts; and ``value`` of any quantity."""


def public(path: Path) -> Iterator[tuple[str, ast.FunctionDef, str]]:
    """Public functions and methods, with what their docstrings say."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    places: list[tuple[str, ast.Module | ast.ClassDef]] = [("", tree)]
    places += [(f"{n.name}.", n) for n in tree.body if isinstance(n, ast.ClassDef)]
    for prefix, place in places:
        if prefix.startswith("_"):
            continue
        own = ast.get_docstring(place) or "" if isinstance(place, ast.ClassDef) else ""
        for node in place.body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                yield prefix + node.name, node, own + (ast.get_docstring(node) or "")


def floats(node: ast.FunctionDef) -> list[str]:
    """Arguments that are numbers whose name tells no unit."""
    given = (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
    return [
        a.arg
        for a in given
        if a.annotation is not None
        and ast.unparse(a.annotation) in ("float", "float | None")
        and not IN_THE_NAME.search(a.arg)
        and a.arg not in NUMBERS
    ]


def test_public_functions_with_float_arguments_state_units() -> None:
    silent = [
        f"{path.relative_to(ROOT)} {name}: {', '.join(floats(node))}"
        for room in ROOMS
        for path in sorted((ROOT / room).rglob("*.py"))
        for name, node, text in public(path)
        if floats(node) and not IN_THE_TEXT.search(text)
    ]
    assert silent == []


def test_a_function_without_a_unit_is_seen(tmp_path: Path) -> None:
    code = 'def turn(angle: float, wait_s: float) -> None:\n    """Turn by an angle."""\n'
    (tmp_path / "x.py").write_text(code, encoding="utf-8")
    ((_, node, text),) = public(tmp_path / "x.py")
    assert floats(node) == ["angle"]
    assert not IN_THE_TEXT.search(text)
    assert IN_THE_TEXT.search(text + " ``angle`` [rad].")
