"""Sizes, colours and paragraph styles of a page."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Final

from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm

from surveyapp.report.pdf.fonts import BASE

MARGIN: Final = 18.0 * mm
WIDTH: Final = A4[0] - 2.0 * MARGIN
BODY, SMALL, CELL = 9.0, 7.0, 7.5
INK: Final = colors.HexColor("#1a1a1a")
QUIET: Final = colors.HexColor("#6b6b6b")
RULE: Final = colors.HexColor("#9aa0a6")
PALE: Final = colors.HexColor("#d9dcdf")
TINT: Final = colors.HexColor("#eef1f4")
ACCENT: Final = colors.HexColor("#1f4e79")


@lru_cache(maxsize=256)
def style_of(size: float, **more: Any) -> ParagraphStyle:
    """A paragraph style of a size [points], with what differs from the usual."""
    settings: dict[str, Any] = {
        "fontName": BASE,
        "fontSize": size,
        "leading": 1.32 * size,
        "textColor": INK,
        **more,
    }
    return ParagraphStyle("style", **settings)
