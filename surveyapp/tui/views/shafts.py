"""An orientation through shafts as rows of text."""

from __future__ import annotations

from surveyapp.domain.shaft import CHECK_IDS
from surveyapp.domain.shaft_result import ShaftOrientation, SideAzimuth
from surveyapp.languages import translated
from surveyapp.tui import texts
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle

AZIMUTH_COLUMNS = (texts.COL_WHAT, texts.COL_RESULT, texts.COL_BOUND, texts.COL_VERDICT)
PLUMBING_COLUMNS = (texts.COL_WHAT, texts.COL_DONE, texts.COL_BY, texts.COL_NOTE)
WORDS = {True: texts.MET, False: texts.NOT_MET, None: ""}


def state_text(shaft: ShaftOrientation, unit: AngleUnit) -> str:
    """The azimuth of the oriented side."""
    best = shaft.combined.azimuth
    if best is None:
        return texts.S_CONTRADICTION.format(id=shaft.id)
    return texts.S_STATE.format(
        id=shaft.id,
        at=shaft.at,
        to=shaft.to,
        azimuth=format_angle(best.value, unit),
        sigma=f'{best.sigma * RHO_ARCSEC:.1f}"',
    )


def azimuth_rows(shaft: ShaftOrientation, unit: AngleUnit) -> list[tuple[str, ...]]:
    """Azimuths, then every check."""

    def row(name: str, value: SideAzimuth | None, word: str = "") -> tuple[str, ...]:
        if value is None:
            return name, "-", "-", word
        return name, format_angle(value.value, unit), f'±{value.sigma * RHO_ARCSEC:.1f}"', word

    rows = [row(texts.S_WIRES, shaft.azimuth), row(texts.S_GYRO, shaft.gyro)]
    if shaft.gyro is not None:
        word = WORDS[shaft.combined.consistent]
        rows.append(row(texts.S_TOGETHER, shaft.combined.azimuth, word))
    rows += [
        (
            texts.S_TRIANGLE.format(station=item.station, place=item.place),
            f"{item.f_mm:+.2f} mm",
            f"{item.limit_mm:.2f} mm",
            WORDS[item.passed],
        )
        for item in shaft.triangles
    ]
    if shaft.scale is not None:
        scale = shaft.scale
        values = (f"{scale.misclosure_mm:+.2f} mm", f"{scale.limit_mm:.2f} mm")
        rows.append((texts.S_SCALE, *values, WORDS[scale.passed]))
    depth = shaft.depth
    difference = "-" if depth.difference_mm is None else f"{depth.difference_mm:.2f} mm"
    name = texts.S_DEPTH.format(depth=f"{depth.m:.4f}")
    rows.append((name, difference, f"{depth.limit_mm:.2f} mm", WORDS[depth.passed]))
    rows.append((texts.S_CONVERGENCE, f"{shaft.convergence_mm:.2f} mm", "", ""))
    return rows


def budget_pairs(shaft: ShaftOrientation) -> list[tuple[str, str]]:
    """The error of one orientation by the wires."""
    return [
        (
            translated(line.source.replace("_", " ")),
            f'{line.sigma * RHO_ARCSEC:.2f}"  {line.share:.0%}',
        )
        for line in shaft.budget
    ]


def plumbing_rows(shaft: ShaftOrientation) -> list[tuple[str, ...]]:
    """The checks of the plumbing, open ones too."""
    recorded = {check.id: check for check in shaft.checks}
    rows: list[tuple[str, ...]] = []
    for name in CHECK_IDS:
        check = recorded.get(name)
        words = translated(name.replace("_", " "))
        if check is None:
            rows.append((words, texts.P_OPEN, "", ""))
        else:
            rows.append((words, check.done_at or texts.P_OPEN, check.by, check.note))
    return rows


def swing_title(shaft: ShaftOrientation, wire: str, axis: str) -> str:
    """Rest of one wire on one scale."""
    rest = next(item for item in shaft.wires if item.name == wire)
    value = rest.x_mm if axis == "x" else rest.y_mm
    sigma = rest.sigma_x_mm if axis == "x" else rest.sigma_y_mm
    return texts.S_SWING.format(
        wire=wire,
        axis=axis,
        rest="-" if value is None else f"{value:.3f}",
        sigma="-" if sigma is None else f"{sigma:.3f}",
        period=f"{rest.period_s:.1f}",
    )
