"""What a record is made of: plain blocks that a terminal and a PDF page can both show.

A section turns results into blocks; whoever shows blocks knows no surveying. All text is final:
numbers are formatted by the section, lengths in figures are millimetres on paper.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal

Tone = Literal["body", "small", "warning"]
Stroke = Literal["axis", "grid", "data", "mean", "limit", "bar"]
Anchor = Literal["start", "middle", "end"]
Shape = Literal["circle", "dot", "cross", "square"]


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading; level 1 opens a section."""

    text: str
    level: int = 1


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text."""

    text: str
    tone: Tone = "body"


@dataclass(frozen=True, slots=True)
class KeyValues:
    """Facts, one a line."""

    pairs: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A table.

    Parameters
    ----------
    head : tuple of str
    rows : tuple of tuple of str
        Each as long as the head.
    align : str
        One letter a column: l, r or c; empty: all to the left.
    struck : frozenset of int
        Rows that were struck: shown, with a line through them.
    strong : frozenset of int
        Rows that are results.
    row_height_mm : float or None
        At least this high: for forms to be filled in by hand.
    lined : bool
        Whether every cell is framed.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    align: str = ""
    struck: frozenset[int] = frozenset()
    strong: frozenset[int] = frozenset()
    row_height_mm: float | None = None
    lined: bool = False


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line of a figure [mm]."""

    start: tuple[float, float]
    end: tuple[float, float]
    stroke: Stroke = "axis"


@dataclass(frozen=True, slots=True)
class Polyline:
    """A curve of a figure through its points [mm]."""

    points: tuple[tuple[float, float], ...]
    stroke: Stroke = "data"


@dataclass(frozen=True, slots=True)
class Marker:
    """A mark of a figure at a point [mm]."""

    at: tuple[float, float]
    shape: Shape = "circle"


@dataclass(frozen=True, slots=True)
class Label:
    """A text of a figure [mm]."""

    at: tuple[float, float]
    text: str
    anchor: Anchor = "middle"
    upright: bool = False


Primitive = Line | Polyline | Marker | Label


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of vector primitives, its origin at the lower left [mm]."""

    title: str
    width_mm: float
    height_mm: float
    primitives: tuple[Primitive, ...] = ()


@dataclass(frozen=True, slots=True)
class Signature:
    """Lines to be signed, one a role."""

    roles: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PageBreak:
    """What follows begins on a new page."""


@dataclass(frozen=True, slots=True)
class ForWidth:
    """The same facts twice: with the width of a page, and for a terminal.

    Parameters
    ----------
    page, narrow : tuple of Block
    """

    page: tuple[Block, ...]
    narrow: tuple[Block, ...]


Block = Heading | Paragraph | KeyValues | Table | Figure | Signature | PageBreak | ForWidth


def on_page(blocks: Iterable[Block]) -> Iterator[Block]:
    """The blocks as a page shows them."""
    for block in blocks:
        if isinstance(block, ForWidth):
            yield from on_page(block.page)
        else:
            yield block


def without_figures(blocks: Iterable[Block]) -> tuple[Block, ...]:
    """The blocks that tell everything in words and numbers."""
    return tuple(block for block in blocks if not isinstance(block, Figure))


@dataclass(frozen=True, slots=True)
class Document:
    """A whole document.

    Parameters
    ----------
    title : str
    running_head : str
        At the top of every page.
    foot : tuple of str
        At the bottom of every page, beside the page number.
    blocks : tuple of Block
    stamp : str
        Among the properties of the file: which state of a project it shows.
    """

    title: str
    running_head: str
    foot: tuple[str, ...]
    blocks: tuple[Block, ...] = field(default=())
    stamp: str = ""
