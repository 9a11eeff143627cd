"""What nothing uses is not there: names that stand only where they are defined, or in tests."""

from __future__ import annotations

import ast
import re
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORD = re.compile(r"\b[A-Za-z_]\w*\b")
CALLED_BY_OTHERS = {
    "_check_value",  # argparse
    "filterFlowables",  # reportlab
    "setDocumentLocator",  # the XML parser
    "startElement",
    "endElement",
    "skippedEntity",
    "PROJECT_LEVEL",  # what the shares of the levels may sum to: tests/core/test_known_values
}
Defined = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


def files(*rooms: str) -> list[Path]:
    return [path for room in rooms for path in sorted((ROOT / room).rglob("*.py"))]


def defined(path: Path) -> list[str]:
    """Functions, methods and classes of a module, and constants at its top."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names = [node.name for node in ast.walk(tree) if isinstance(node, Defined)]
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets += [node.target] if isinstance(node, ast.AnnAssign) else []
        names += [target.id for target in targets if isinstance(target, ast.Name)]
    return names


def test_every_name_is_used_somewhere_else_than_in_tests() -> None:
    """The screens are left out (textual calls them), and the models, a library of closed forms."""
    used: Counter[str] = Counter()
    for path in files("surveyapp", "models", "scripts", "bench"):
        used.update(WORD.findall(path.read_text(encoding="utf-8")))
    names = Counter(
        name
        for path in files("surveyapp")
        if "tui" not in path.relative_to(ROOT).parts
        for name in defined(path)
        if not name.startswith("__")
    )
    dead = {name for name, count in names.items() if used[name] <= count}
    assert dead == CALLED_BY_OTHERS
