"""Counts of the house: rooms, floors and arrows between them, from the imports of a checkout.

``python -m scripts.count_rooms [FOLDER]``: for the top of the package and for its core, how many
rooms (modules or packages) there are, how many pairs of them import each other, and how many floors
the longest chain of imports has. Rooms that import each other in a ring share a floor.
"""

from __future__ import annotations

import ast
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path

PACKAGES = ("surveyapp", "surveyapp.core", "surveyapp.diagnosis", "surveyapp.io")


def imports(root: Path) -> dict[str, set[str]]:
    """Modules that each module of the package imports, functions and type checking included."""
    paths = {
        ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path
        for path in sorted((root / "surveyapp").rglob("*.py"))
    }
    found: dict[str, set[str]] = defaultdict(set)
    for name, path in paths.items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                deeper = {f"{node.module}.{item.name}" for item in node.names} & paths.keys()
                found[name] |= deeper or ({node.module} & paths.keys())
            elif isinstance(node, ast.Import):
                found[name] |= {item.name for item in node.names} & paths.keys()
        found[name].discard(name)
    return found


def room_of(module: str, package: str) -> str | None:
    """The room of a package in which a module stands; None outside of it or for its root."""
    if not module.startswith(package + "."):
        return None
    return module.removeprefix(package + ".").split(".")[0]


def plan(found: dict[str, set[str]], package: str) -> tuple[int, int, int]:
    """Rooms, floors and arrows of one package."""
    rooms = {room for name in found if (room := room_of(name, package)) is not None}
    below: dict[str, set[str]] = {room: set() for room in rooms}
    for name, used in found.items():
        here = room_of(name, package)
        if here is not None:
            below[here] |= {r for u in used if (r := room_of(u, package)) not in (None, here)}

    @cache
    def reached(room: str) -> frozenset[str]:
        seen, rest = set[str](), [room]
        while rest:
            for item in below[rest.pop()] - seen:
                seen.add(item)
                rest.append(item)
        return frozenset(seen)

    @cache
    def floor(room: str) -> int:
        under = [item for item in reached(room) if room not in reached(item)]
        return 1 + max((floor(item) for item in under), default=0)

    return len(rooms), max(map(floor, rooms), default=0), sum(map(len, below.values()))


def main() -> None:
    """Print the counts of a checkout."""
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1]
    found = imports(root)
    print(f"{'package':22}{'rooms':>6}{'floors':>8}{'arrows':>8}")
    for package in PACKAGES:
        rooms, floors, arrows = plan(found, package)
        print(f"{package:22}{rooms:6}{floors:8}{arrows:8}")


if __name__ == "__main__":
    main()
