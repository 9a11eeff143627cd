"""Instrument constants as rows of text."""

from __future__ import annotations

from surveyapp.domain.results import OrientationResult
from surveyapp.tui import texts
from surveyapp.tui.views.form import arcsec_text, number_text

CONSTANT_COLUMNS = (
    texts.COL_INSTRUMENT,
    texts.COL_LINE,
    texts.COL_CONSTANT,
    texts.COL_SIGMA,
    texts.COL_COUNT,
    texts.COL_LENGTH,
)


def constant_rows(result: OrientationResult) -> list[tuple[str, ...]]:
    """One row for each calibration line, then what is made of them."""
    rows: list[tuple[str, ...]] = []
    for constant in result.constants:
        rows += [
            (
                constant.instrument,
                f"{line.station}-{line.target}",
                arcsec_text(line.value, 2, sign=True),
                arcsec_text(line.sigma, 2),
                str(line.count),
                number_text(line.distance_m),
            )
            for line in constant.by_line
        ]
        if constant.value is not None:
            stable = {True: texts.STABLE, False: texts.NOT_STABLE, None: ""}[constant.stable]
            rows.append(
                (
                    constant.instrument,
                    f"{constant.choice} {stable}".strip(),
                    arcsec_text(constant.value, 2, sign=True),
                    arcsec_text(constant.sigma, 2),
                    str(constant.count),
                    "",
                )
            )
    return rows
