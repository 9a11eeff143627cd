"""Blocks of the record as text of a screen: the same words and numbers, in another medium."""

from __future__ import annotations

from collections.abc import Iterable

from rich.text import Text

from surveyapp.report.blocks import Block, ForWidth, Heading, Paragraph, Table, without_figures
from surveyapp.report.in_words import in_words
from surveyapp.report.text import block_text, table_lines

LEAST_WIDTH = 30


def blocks_as_text(blocks: Iterable[Block], width: int) -> Text:
    """Blocks below each other, figures left out: a screen draws its own.

    Parameters
    ----------
    blocks : iterable of Block
    width : int
        Columns that there are.
    """
    text = Text()
    last = None
    for block in in_words(without_figures(blocks)):
        part = _block(block, max(width, LEAST_WIDTH))
        if not part:
            continue
        tone = block.tone if isinstance(block, Paragraph) else None
        if text:
            text.append("\n" if tone is not None and tone == last != "body" else "\n\n")
        text.append_text(part)
        last = tone
    return text


def _block(block: Block, width: int) -> Text:
    if isinstance(block, ForWidth):
        return blocks_as_text(block.narrow, width)
    if isinstance(block, Heading):
        return Text(block.text, style="bold underline" if block.level == 1 else "bold")
    if isinstance(block, Table):
        text = Text()
        for row, line in table_lines(block, width, indent=0):
            style = "dim" if row is None else "bold" if row in block.strong else ""
            text.append(f"{line}\n", style=style)
        text.rstrip()
        return text
    return Text(block_text(block, width))


__all__ = ["blocks_as_text"]
