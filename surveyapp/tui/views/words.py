"""Words with pictures in the width that a window has."""

from __future__ import annotations

import re
from typing import Final

from surveyapp.report.text import display_width, filled

_DRAWN: Final = re.compile(r"[|_\\\u2500-\u25ff]|(?<!\w)/|--[-|]|~~")
"""What drawings are made of; an arrow of a chain is none."""


def refilled(words: str, width: int) -> str:
    """Paragraphs in lines of a width [columns] where they are wider; pictures as they are.

    A paragraph that is drawn has a line that begins with a blank, or gaps within its lines.
    """
    parts = words.rstrip("\n").split("\n\n")
    return "\n\n".join(_refilled(part, width) for part in parts)


def _refilled(part: str, width: int) -> str:
    lines = part.split("\n")
    if max(map(display_width, lines)) <= width:
        return part
    if any(line.startswith(" ") or "   " in line.strip() for line in lines):
        return "\n".join(_narrower(line, width) for line in lines)
    wide = any(display_width(line) > len(line) for line in lines)
    return filled(("" if wide else " ").join(lines), width)


def _narrower(line: str, width: int) -> str:
    """A line of a table or a chain of words in several, set in; a drawing as it is."""
    words = line.strip()
    if display_width(line) <= width or _DRAWN.search(words):
        return line
    margin = line[: len(line) - len(line.lstrip())]
    return margin + filled(words, width - len(margin), set_in=f"{margin}  ")
