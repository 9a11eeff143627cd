"""Blocks on paper: the only package that imports reportlab, and it knows no surveying.

The same document gives the same bytes: no clock, no random identifier. Latin, Greek and Cyrillic
are drawn with an embedded face, Chinese, Japanese and Korean with a TrueType face that is named or
found, else with the CID faces that PDF viewers bring.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from reportlab import rl_config
from reportlab.lib.pagesizes import A4
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import (
    BaseDocTemplate,
    CondPageBreak,
    Flowable,
    Frame,
    KeepTogether,
    PageTemplate,
    Spacer,
)
from reportlab.platypus import PageBreak as NewPage
from reportlab.platypus import Paragraph as Text
from reportlab.platypus import Table as Grid

from surveyapp.domain.advance import Advance, silent
from surveyapp.languages import said, said_each, shown
from surveyapp.report.blocks import (
    Block,
    Document,
    Figure,
    ForWidth,
    Heading,
    KeyValues,
    PageBreak,
    Paragraph,
    Signature,
    Table,
)
from surveyapp.report.in_words import in_words
from surveyapp.report.pdf.figures import figure_flowables
from surveyapp.report.pdf.fonts import BASE, Faces, register_faces
from surveyapp.report.pdf.style import (
    ACCENT,
    BODY,
    CELL,
    INK,
    MARGIN,
    QUIET,
    RULE,
    SMALL,
    WIDTH,
    style_of,
)
from surveyapp.report.pdf.tables import is_tall, plain_or_wrapped, row_heights, table_flowable


@dataclass(frozen=True, slots=True)
class Written:
    """What was written: the bytes, the number of pages, and texts with letters no face has."""

    data: bytes
    pages: int
    missing: tuple[tuple[str, str], ...] = ()
    referred: tuple[str, ...] = ()


def write_pdf(
    document: Document, *, face: Path | None = None, advance: Advance = silent
) -> Written:
    """Write a document as PDF.

    Parameters
    ----------
    document : Document
    face : Path or None
        TrueType face for what the embedded face lacks; None: one found on the system.
    advance : callable
        Told how many pages are made.

    Raises
    ------
    SurveyError
        If the named face cannot be embedded.
    """
    rl_config.useA85 = 0  # binary streams: a quarter smaller, and nothing spent on writing text
    rl_config.shapeChecking = 0
    faces = register_faces(face)
    document = in_words(document)
    stream = io.BytesIO()
    template = _Template(
        stream,
        pagesize=A4,
        leftMargin=MARGIN,
        rightMargin=MARGIN,
        topMargin=MARGIN,
        bottomMargin=MARGIN,
        title=document.title,
        author="",
        creator="surveyapp",
        keywords=[document.stamp],
        invariant=1,
        pageCompression=1,
    )
    frame = Frame(
        MARGIN,
        20.0 * mm,
        WIDTH,
        A4[1] - 40.0 * mm,
        leftPadding=0,
        rightPadding=0,
        topPadding=0,
        bottomPadding=0,
    )
    pages = [0]

    def furniture(canvas: Canvas, _: object) -> None:
        pages[0] = canvas.getPageNumber()
        advance("pages", pages[0], 0)
        _draw_furniture(canvas, document, faces)

    template.addPageTemplates([PageTemplate(id="page", frames=[frame], onPage=furniture)])
    template.build(_Story(_flowables(document, faces)), canvasmaker=_Canvas.maker(faces))
    missing = tuple(sorted(faces.missing.items()))
    return Written(stream.getvalue(), pages[0], missing, tuple(sorted(faces.referred)))


class _Story(list[Flowable]):
    """Flowables that are made when they are needed: a long document is never whole."""

    def __init__(self, blocks: Iterator[list[Flowable]]) -> None:
        super().__init__()
        self._blocks = blocks
        self.fetch()

    def fetch(self) -> None:
        """Make the next ones."""
        while len(self) < _AHEAD and (more := next(self._blocks, None)) is not None:
            self.extend(more)


class _Template(BaseDocTemplate):
    """A document that takes its flowables from a ``_Story``."""

    def filterFlowables(self, flowables: list[Flowable]) -> None:
        """Called before each flowable is taken."""
        if isinstance(flowables, _Story):
            flowables.fetch()


_AHEAD: Final = 8
_NUMBER: Final = "page-number-{}"


class _Canvas(Canvas):
    """Draws ``page 3 of 7`` at the end, when the number of pages is known."""

    _faces: Faces

    @classmethod
    def maker(cls, faces: Faces) -> Callable[..., Canvas]:
        """A function that makes such a canvas."""

        def make(*arguments: Any, **settings: Any) -> Canvas:
            canvas = cls(*arguments, **settings)
            canvas._faces = faces
            return canvas

        return make

    def save(self) -> None:
        """Define what every page has left open, then write."""
        total = self.getPageNumber() - 1
        for number in range(1, total + 1):
            self.beginForm(_NUMBER.format(number), upperx=A4[0], uppery=A4[1])
            text = shown(said("page {number} of {total}", number=number, total=total))
            right = MARGIN + WIDTH - self._faces.width(text, SMALL)
            self.setFillColor(QUIET)
            _draw_text(self, self._faces, text, (right, _BOTTOM - 3.5 * mm), size=SMALL)
            self.endForm()
        super().save()


def _draw_text(
    canvas: Canvas, faces: Faces, text: str, at: tuple[float, float], *, size: float
) -> None:
    x, y = at
    for name, run in faces.split(text):
        canvas.setFont(name, size)
        canvas.drawString(x, y, run)
        x += pdfmetrics.stringWidth(run, name, size)


def _fitted(faces: Faces, text: str, size: float, room: float) -> str:
    if faces.width(text, size) <= room:
        return text
    least, most = 0, len(text)
    while least < most:
        middle = (least + most + 1) // 2
        fits = faces.width(text[:middle] + "...", size) <= room
        least, most = (middle, most) if fits else (least, middle - 1)
    return text[:least] + "..."


_BOTTOM: Final = 16.0 * mm
_PAGE_ROOM: Final = "страница 0000 из 0000"
"""As wide as a page number may become: the lines of the foot keep away from it."""


def _draw_furniture(canvas: Canvas, document: Document, faces: Faces) -> None:
    canvas.saveState()
    canvas.setFillColor(QUIET)
    canvas.setStrokeColor(RULE)
    canvas.setLineWidth(0.4)
    top, bottom = A4[1] - 14.0 * mm, _BOTTOM
    head = _fitted(faces, document.running_head, SMALL + 0.5, WIDTH)
    _draw_text(canvas, faces, head, (MARGIN, top), size=SMALL + 0.5)
    canvas.line(MARGIN, top - 1.5 * mm, MARGIN + WIDTH, top - 1.5 * mm)
    canvas.line(MARGIN, bottom, MARGIN + WIDTH, bottom)
    canvas.doForm(_NUMBER.format(canvas.getPageNumber()))
    right = faces.width(_PAGE_ROOM, SMALL)
    for index, line in enumerate(document.foot):
        text = _fitted(faces, line, SMALL - 0.5, WIDTH - right - 4.0 * mm)
        at = (MARGIN, bottom - (3.5 + 2.8 * index) * mm)
        _draw_text(canvas, faces, text, at, size=SMALL - 0.5)
    canvas.restoreState()


def _flowables(document: Document, faces: Faces) -> Iterator[list[Flowable]]:
    yield [Text(faces.markup(document.title), style_of(17.0, textColor=ACCENT, spaceAfter=5.0))]
    blocks = document.blocks
    index = 0
    while index < len(blocks):
        block = blocks[index]
        following = blocks[index + 1] if index + 1 < len(blocks) else None
        if isinstance(block, Heading) and isinstance(following, Signature):
            room = _HEADING_ROOM + sum(_signature_heights(following))
            yield [CondPageBreak(room), *_block(block, faces), _signature(following, faces)]
            index += 2
            continue
        if isinstance(block, Heading) and isinstance(following, Figure | KeyValues):
            # side by side: one such block within another asks for a page of its own
            yield [KeepTogether([*_block(block, faces), *_whole(following, faces)])]
            index += 2
            continue
        yield _block(block, faces)
        index += 1


def _block(block: Block, faces: Faces) -> list[Flowable]:
    match block:
        case Heading():
            return _heading(block, faces)
        case Paragraph():
            return [_paragraph(block, faces)]
        case KeyValues():
            return _whole(block, faces)
        case Table():
            return [table_flowable(block, faces), Spacer(0, 2.5 * mm)]
        case Figure():
            return [KeepTogether(_whole(block, faces))]
        case Signature():
            return [KeepTogether([_signature(block, faces)])]
        case ForWidth():
            return [flowable for item in block.page for flowable in _block(item, faces)]
        case PageBreak():
            return [NewPage()]


def _whole(block: Figure | KeyValues, faces: Faces) -> list[Flowable]:
    """What stands on one page with its heading."""
    match block:
        case Figure():
            return [*figure_flowables(block, faces), Spacer(0, 3.0 * mm)]
        case KeyValues():
            return [_key_values(block, faces), Spacer(0, 2.0 * mm)]


def _heading(block: Heading, faces: Faces) -> list[Flowable]:
    if block.level == 1:
        style = style_of(13.0, textColor=ACCENT, spaceBefore=6.0, spaceAfter=3.0)
        need = 45.0 * mm
    else:
        style = style_of(10.0, textColor=ACCENT, spaceBefore=5.0, spaceAfter=2.0)
        need = 30.0 * mm
    return [CondPageBreak(need), Text(faces.markup(block.text), style)]


def _paragraph(block: Paragraph, faces: Faces) -> Flowable:
    size = SMALL if block.tone == "small" else BODY
    style = style_of(size, spaceAfter=3.0)
    if block.tone == "warning":
        style = style_of(
            size,
            spaceAfter=7.0,
            leftIndent=6.0,
            borderColor=INK,
            borderWidth=0.8,
            borderPadding=(3.0, 4.0, 3.0, 4.0),
            spaceBefore=7.0,
            rightIndent=4.0,
        )
    return Text(faces.markup(block.text), style)


_BESIDE: Final = 0.6
"""Above and below a key and its value [points]."""


def _key_values(block: KeyValues, faces: Faces) -> Flowable:
    wanted = max((faces.width(key, CELL + 0.5) for key, _ in block.pairs), default=0.0)
    first = min(wanted + 4.0 * mm, 0.4 * WIDTH)
    widths, size = (first, WIDTH - first), CELL + 0.5
    styles = style_of(size, textColor=QUIET), style_of(size)
    rows = [
        [
            plain_or_wrapped(faces, text, width - 2.0, style)
            for text, width, style in zip(pair, widths, styles, strict=True)
        ]
        for pair in block.pairs
    ]
    tall = is_tall(faces, block.pairs, widths, size)
    grid = Grid(
        rows,
        colWidths=list(widths),
        rowHeights=row_heights(rows, styles[0].leading, 2.0 * _BESIDE),
        hAlign="LEFT",
        splitInRow=int(tall),
    )
    grid.setStyle(
        [
            ("FONT", (0, 0), (-1, -1), BASE, size, styles[0].leading),
            ("TEXTCOLOR", (0, 0), (0, -1), QUIET),
            ("TEXTCOLOR", (1, 0), (1, -1), INK),
            ("VALIGN", (0, 0), (-1, -1), "TOP"),
            ("LEFTPADDING", (0, 0), (-1, -1), 0),
            ("RIGHTPADDING", (0, 0), (-1, -1), 2),
            ("TOPPADDING", (0, 0), (-1, -1), _BESIDE),
            ("BOTTOMPADDING", (0, 0), (-1, -1), _BESIDE),
        ]
    )
    return grid


_HEADING_ROOM: Final = 15.0 * mm


def _signature_heights(block: Signature) -> list[float]:
    return [5.0 * mm, *[13.0 * mm] * len(block.roles)]


def _signature(block: Signature, faces: Faces) -> Flowable:
    style = style_of(CELL + 0.5)
    labels = [shown(text) for text in said_each("role", "name and signature", "place and date")]
    quiet = style_of(SMALL, textColor=QUIET)
    rows: list[list[Flowable | str]] = [[Text(faces.markup(label), quiet) for label in labels]]
    rows += [[Text(faces.markup(role), style), "", ""] for role in block.roles]
    heights = _signature_heights(block)
    grid = Grid(rows, colWidths=[0.28 * WIDTH, 0.44 * WIDTH, 0.28 * WIDTH], rowHeights=heights)
    grid.setStyle(
        [
            ("VALIGN", (0, 0), (-1, -1), "BOTTOM"),
            ("LINEBELOW", (1, 1), (1, -1), 0.6, INK),
            ("LINEBELOW", (2, 1), (2, -1), 0.6, INK),
            ("LEFTPADDING", (0, 0), (-1, -1), 2),
        ]
    )
    return grid
