"""Columns written as a log that this program, and any spreadsheet, reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from surveyapp.domain.advance import PartDone
from surveyapp.domain.columns import let_go
from surveyapp.io.outputs import check_output
from surveyapp.io.tomltext import atomic_write
from surveyapp_models.arrays import Floats

Columns = Mapping[str, Sequence[float] | Sequence[str] | Floats]

BLOCK_ROWS: Final = 20_000
"""Rows of which the text is made at once."""


def columns_text(columns: Columns) -> str:
    """CSV text: names, then one line a row; NaN as an empty cell.

    Numbers are written with twelve digits, words as they are.
    """
    return _names(columns) + _rows(columns)


def _names(columns: Columns) -> str:
    return ",".join(columns) + "\n"


def _rows(columns: Columns) -> str:
    cells = [
        [
            value if isinstance(value, str) else "" if np.isnan(value) else f"{value:.12g}"
            for value in values
        ]
        for values in columns.values()
    ]
    return "".join(",".join(row) + "\n" for row in zip(*cells, strict=True))


def _pieces(parts: Iterable[Columns]) -> Iterator[bytes]:
    """The text block by block; every part has the columns of the first."""
    begun = False
    for part in parts:
        if not begun:
            yield _names(part).encode()
            begun = True
        size = max((len(values) for values in part.values()), default=0)
        for start in range(0, size, BLOCK_ROWS):
            block = {name: values[start : start + BLOCK_ROWS] for name, values in part.items()}
            yield _rows(block).encode()
            for values in part.values():
                if isinstance(values, np.ndarray):
                    let_go(values)


def write_columns(
    path: Path,
    columns: Columns,
    *,
    inputs: Iterable[Path] = (),
    progress: PartDone | None = None,
) -> None:
    """Write a CSV file as a whole, never over one of the inputs.

    Raises
    ------
    SurveyError
        If an input or the record of a project stands there, or the system refuses.
    """
    write_parts(path, _parts(columns, progress), inputs=inputs)


def _parts(columns: Columns, progress: PartDone | None) -> Iterator[Columns]:
    """Columns in parts of a block; the share that was written is told."""
    size = max((len(values) for values in columns.values()), default=0)
    for start in range(0, max(size, 1), BLOCK_ROWS):
        yield {name: values[start : start + BLOCK_ROWS] for name, values in columns.items()}
        if progress is not None:
            progress(min((start + BLOCK_ROWS) / max(size, 1), 1.0))


def write_parts(path: Path, parts: Iterable[Columns], *, inputs: Iterable[Path] = ()) -> None:
    """Write a CSV file of parts that follow each other; only one of them is in memory.

    Raises
    ------
    SurveyError
        If an input or the record of a project stands there, or the system refuses.
    """
    check_output(path, inputs)
    atomic_write(path, _pieces(parts))
