"""Write the generated reference pages, or check that they are current (``--check``).

Each module named in ``PAGE_MODULES`` has a function ``pages()`` that returns the text of its pages
by path below ``docs/``.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "models")]

PAGE_MODULES: tuple[str, ...] = (
    "pages_api",
    "pages_campaign",
    "pages_cards",
    "pages_catalogues",
    "pages_command_line",
    "pages_effects",
    "pages_estimators",
    "pages_latitude",
    "pages_rulebooks",
    "pages_simulator",
)


def all_pages() -> dict[str, str]:
    pages: dict[str, str] = {}
    for name in PAGE_MODULES:
        pages.update(importlib.import_module(f"scripts.{name}").pages())
    return pages


def main(arguments: list[str]) -> int:
    stale = []
    for relative, text in sorted(all_pages().items()):
        path = ROOT / "docs" / relative
        current = path.read_text(encoding="utf-8") if path.exists() else None
        if current == text:
            continue
        if "--check" in arguments:
            stale.append(relative)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            print(f"written docs/{relative}")
    if stale:
        print("not current: " + ", ".join(stale) + " (run make docs)", file=sys.stderr)
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
