"""Words with pictures in the width that a window has."""

from __future__ import annotations

from surveyapp.report.text import display_width, filled


def refilled(words: str, width: int) -> str:
    """Paragraphs in lines of a width [columns] where they are wider; pictures as they are.

    A paragraph that is drawn has a line that begins with a blank, or gaps within its lines.
    """
    parts = words.rstrip("\n").split("\n\n")
    return "\n\n".join(_refilled(part, width) for part in parts)


def _refilled(part: str, width: int) -> str:
    lines = part.split("\n")
    fits = max(map(display_width, lines)) <= width
    if fits or any(line.startswith(" ") or "   " in line.strip() for line in lines):
        return part
    wide = any(display_width(line) > len(line) for line in lines)
    return filled(("" if wide else " ").join(lines), width)
