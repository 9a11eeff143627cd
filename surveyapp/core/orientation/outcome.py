"""A computed orientation turned into results: values, sigmas and intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.core.orientation.combined_lines import combined_lines
from surveyapp.core.orientation.instrument_constant import InstrumentConstant
from surveyapp.core.orientation.lines import angle_result
from surveyapp.core.orientation.sequence import session_moments
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.swing.session import ReducedSession, TargetReduction
from surveyapp.domain.results import (
    Check,
    ConstantResult,
    Determination,
    LineConstant,
    OrientationResult,
    SessionResult,
    TapeZeroResult,
    TargetResult,
)
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said


def outcome(
    orientation: Orientation,
    checks: Sequence[Check],
    *,
    software: str,
    only: str | None = None,
) -> OrientationResult:
    """Results of a computed orientation.

    Parameters
    ----------
    orientation : Orientation
    checks : sequence of Check
        Those that are shown.
    software : str
        Name and version for the head of the result.
    only : str or None
        Show this session alone.
    """
    shown = [item for item in orientation.sessions if only is None or item.session.id == only]
    warnings = [*orientation.warnings]
    for item in shown:
        warnings += item.warnings
    predicted = frozenset(
        c.instrument.id for c in orientation.constants if c.choice.kind == "predicted" and c.average
    )
    warnings += _loud(checks, predicted)
    return OrientationResult(
        project=orientation.project.name,
        software=software,
        input_sha256=orientation.project.digest,
        sessions=tuple(session_result(item) for item in shown),
        constants=tuple(constant_result(orientation, item) for item in orientation.constants),
        lines=tuple(line.result for line in orientation.shown_lines),
        checks=tuple(checks),
        warnings=tuple(warnings),
        combined=combined_lines(orientation.shown_lines, orientation.deflections),
    )


_CHOOSE = said(
    "; nothing is averaged silently: the pooled sigma contains the "
    "disagreement; choose with constant_choice = pooled, nearest, interpolated "
    "or line:A-B"
)
_INSTEAD = said(
    "; the constant is predicted for each line, averaged over what may be "
    "behind it, and the interval contains that"
)


def _loud(checks: Sequence[Check], predicted: frozenset[str]) -> list[ResultWarning]:
    """A run that the model does not fit, a constant that moved: said again as a warning."""
    found: dict[tuple[str, Subject], list[str]] = {}
    for check in checks:
        if check.warning_code:
            text = check.text
            if check.rule == "constant.lines":
                text += _INSTEAD if check.subject.id in predicted else _CHOOSE
            found.setdefault((check.warning_code, check.subject), []).append(text)
    return [
        ResultWarning(code, joined(": ", (subject.text, joined("; ", texts))), subject)
        for (code, subject), texts in found.items()
    ]


def session_result(item: ReducedSession) -> SessionResult:
    """The result of one session."""
    session, reduction = item.session, item.reduction
    main = reduction.north if reduction.north is not None else reduction.azimuth
    interval = None if main is None or not math.isfinite(main.sigma) else main.interval95
    zero = reduction.tape_zero
    coefficient = reduction.coefficient
    return SessionResult(
        id=session.id,
        station=session.station,
        target=session.target,
        instrument=session.instrument,
        purpose=session.purpose,
        method=session.method,
        estimator=reduction.estimator,
        gyro_north=None if reduction.north is None else angle_result(reduction.north),
        targets=tuple(target_result(target) for target in item.targets),
        points_used=reduction.points_used,
        dof=reduction.dof,
        sigma_source=reduction.sigma_source,
        reading_sigma=reduction.reading_sigma,
        interval95=interval,
        residual_rms=reduction.residual_rms,
        amplitude=reduction.amplitude,
        damping_per_half_swing=reduction.damping_ratio,
        period_s=reduction.period_s,
        tape_zero=None
        if zero is None
        else TapeZeroResult(
            before_div=None if zero.before is None else zero.before.value_div,
            after_div=None if zero.after is None else zero.after.value_div,
            value_div=zero.value_div,
            interpolation=zero.interpolation,
            coefficient=None if coefficient is None else coefficient.value,
            coefficient_origin="" if coefficient is None else coefficient.origin,
            correction=reduction.tape_zero_correction,
            schuler_before_div=() if zero.before is None else zero.before.schuler_div,
            schuler_after_div=() if zero.after is None else zero.after.schuler_div,
        ),
        tape_zero_correction=reduction.tape_zero_correction,
        points=reduction.points,
        schuler_means=reduction.schuler_means,
        quantities=reduction.quantities,
        warnings=item.warnings,
        levelling=session.levelling,
        pre_orientation=session.pre_orientation,
    )


def target_result(item: TargetReduction) -> TargetResult:
    """The result of one target of a session."""
    sights = item.sights
    return TargetResult(
        target=item.target,
        line_reading=None if item.line_reading is None else angle_result(item.line_reading),
        gyro_azimuth=None if item.gyro_azimuth is None else angle_result(item.gyro_azimuth, "GYRO"),
        collimation=None if sights is None else sights.collimation,
        drift=None if sights is None else sights.drift,
        before=None if sights is None else sights.before,
        after=None if sights is None else sights.after,
        pointings=0 if sights is None else sights.pointings,
        eccentric_correction=item.eccentric,
        levelling_correction=item.levelling,
    )


def constant_result(orientation: Orientation, constant: InstrumentConstant) -> ConstantResult:
    """The result of one instrument's constant."""
    value = constant.pooled if constant.pooled is not None else constant.known
    if constant.choice.kind == "predicted" and constant.average is not None:
        value = constant.average
    calibrations = constant.calibrations
    keys = session_moments(orientation.project, constant.instrument.id)
    lines = []
    for line, mean in constant.lines:
        own = [item for item in calibrations if item.line == line]
        lines.append(
            LineConstant(
                station=line.station,
                target=line.target,
                value=mean.value,
                sigma=mean.sigma,
                count=len(own),
                rounds=sum(item.rounds for item in own),
                distance_m=own[0].distance_m,
            )
        )
    finite = value is not None and math.isfinite(value.sigma)
    return ConstantResult(
        instrument=constant.instrument.id,
        value=None if value is None else value.value,
        sigma=None if value is None else value.sigma,
        interval95=value.interval95 if value is not None and finite else None,
        count=len(calibrations),
        stable=constant.stable,
        choice=str(constant.choice) if calibrations or value is None else "known",
        by_line=tuple(lines),
        determinations=tuple(
            Determination(
                session=item.session,
                station=item.station,
                target=item.target,
                value=item.value.value,
                sigma=item.value.sigma,
                moment_s=keys[item.session][0] if item.moment is not None else None,
                phase=item.phase,
                known_azimuth=item.known_azimuth,
                from_coordinates=item.from_coordinates,
            )
            for item in calibrations
        ),
    )
