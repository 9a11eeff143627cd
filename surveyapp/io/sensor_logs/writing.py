"""Columns written as a log that this program, and any spreadsheet, reads."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from surveyapp.io.outputs import write_output
from surveyapp_models.arrays import Floats


def columns_text(columns: Mapping[str, Sequence[float] | Sequence[str] | Floats]) -> str:
    """CSV text: names, then one line a row; NaN as an empty cell.

    Numbers are written with twelve digits, words as they are.
    """
    cells = [
        [
            value if isinstance(value, str) else "" if np.isnan(value) else f"{value:.12g}"
            for value in values
        ]
        for values in columns.values()
    ]
    rows = [",".join(row) for row in zip(*cells, strict=True)]
    return "\n".join([",".join(columns), *rows]) + "\n"


def write_columns(
    path: Path,
    columns: Mapping[str, Sequence[float] | Sequence[str] | Floats],
    *,
    inputs: Iterable[Path] = (),
) -> None:
    """Write a CSV file as a whole, never over one of the inputs.

    Raises
    ------
    SurveyError
        If an input or the record of a project stands there, or the system refuses.
    """
    write_output(path, columns_text(columns).encode(), inputs=inputs)
