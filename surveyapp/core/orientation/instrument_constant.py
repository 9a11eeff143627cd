"""The instrument constant: true minus gyro azimuth, in astronomic terms.

Determinations on known lines before and after the survey (any n-m-k programme) are pooled,
interpolated in time, taken from one line, or compared with a value known beforehand. Where they
disagree, nothing is averaged silently: the disagreement enters the sigma, and the result says so.

Source: physics.md 3.1 and 3.2; Regulation for coal-mine surveying (1989), articles 62 and 63.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from surveyapp.core.orientation.agreement import Agreement, agreement_text
from surveyapp.core.statistics.distributions import f_tail, student_quantile
from surveyapp.core.statistics.levels import CONSISTENT
from surveyapp.core.statistics.repeated import SHARED, weighted_mean
from surveyapp.core.uncertain import Source, Uncertain, combine
from surveyapp.domain.constant_choice import LINE, ConstantChoice
from surveyapp.domain.instrument import Instrument
from surveyapp.domain.station_line import StationLine
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said

Phase = Literal["before", "between", "after"]
POOLED = ConstantChoice("pooled")
PREDICTED = ConstantChoice("predicted")

LEAST_PREDICTED = 4
"""Determinations from which the constant is predicted."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """One determination of the constant.

    Parameters
    ----------
    session, station, target : str
    value : Uncertain
        True minus gyro [rad], wrapped to (-pi, pi].
    phase : str
        before, between or after the survey sessions.
    block : int
        Number of survey sessions before it: one block of calibrations has no survey in it.
    moment : float or None
        Abscissa for interpolation: seconds, or the stated order.
    rounds : int
    known_azimuth, from_coordinates : float or None
        Grid azimuth used, and the one from the coordinates [rad].
    distance_m : float or None
        Length of the line.
    """

    session: str
    station: str
    target: str
    value: Uncertain
    phase: Phase
    moment: float | None
    rounds: int
    known_azimuth: float
    from_coordinates: float | None
    distance_m: float | None
    block: int = 0

    @property
    def line(self) -> StationLine:
        """The line on which it was made."""
        return StationLine(self.station, self.target)


@dataclass(frozen=True, slots=True)
class InstrumentConstant:
    """Everything known of the constant of one instrument.

    Parameters
    ----------
    instrument : Instrument
    calibrations : tuple of Calibration
    lines : tuple of (StationLine, Uncertain)
        Mean of each line.
    line_agreement, phase_agreement : Agreement or None
    known : Uncertain or None
        Known beforehand.
    pooled : Uncertain or None
        Mean of all determinations; a disagreement enters its sigma.
    average : Uncertain or None
        Constant over the campaign, averaged over the base model and its rivals; None where there
        are too few determinations to predict from.
    """

    instrument: Instrument
    calibrations: tuple[Calibration, ...]
    lines: tuple[tuple[StationLine, Uncertain], ...]
    line_agreement: Agreement | None
    phase_agreement: Agreement | None
    known: Uncertain | None
    pooled: Uncertain | None
    average: Uncertain | None = None

    @property
    def set_ups(self) -> int:
        """Independent determinations: several lines sighted from one set-up are one."""
        return len({item.session for item in self.calibrations})

    @property
    def choice(self) -> ConstantChoice:
        """What its sessions use if they say nothing else."""
        if self.instrument.constant_choice is not None:
            return self.instrument.constant_choice
        return POOLED if self.average is None else PREDICTED

    @property
    def stable(self) -> bool | None:
        """False where lines or epochs disagree; None where nothing can tell."""
        tests = [test for test in (self.line_agreement, self.phase_agreement) if test is not None]
        return all(test.agree for test in tests) if tests else None


def compare_groups(groups: Sequence[tuple[str, Uncertain]]) -> Agreement | None:
    """Compare means of two or more groups; None for fewer, or without a sigma.

    The unknown deflection is left out of the comparison: it differs little between neighbouring
    lines, and whoever chooses a line must know of the difference whatever its cause.
    """
    usable = [
        (name, item.without("deflection", "known azimuth", "torsion ratio"))
        for name, item in groups
    ]
    usable = [(name, item) for name, item in usable if 0.0 < item.variance < math.inf]
    if len(usable) < 2:
        return None
    weights = [1.0 / item.variance for _, item in usable]
    total = math.fsum(weights)
    values = [item.value for _, item in usable]
    mean = math.fsum(w * v for w, v in zip(weights, values, strict=True)) / total
    squares = math.fsum(w * (v - mean) ** 2 for w, v in zip(weights, values, strict=True))
    dof = len(usable) - 1
    pooled = combine((1.0, item) for _, item in usable)
    probability = f_tail(squares / dof, dof_numerator=dof, dof_denominator=max(pooled.dof, 1.0))
    external = squares / dof / total
    widest = max(range(len(values)), key=values.__getitem__)
    lowest = min(range(len(values)), key=values.__getitem__)
    spread = usable[widest][1] - usable[lowest][1]
    return Agreement(
        difference=spread.value,
        limit=student_quantile(1.0 - 0.5 * CONSISTENT / dof, max(spread.dof, 1.0)) * spread.sigma,
        agree=probability >= CONSISTENT,
        scatter=math.sqrt(max(external - 1.0 / total, 0.0)),
        dof=dof,
        probability=probability,
        names=tuple(name for name, _ in usable),
    )


def determine(instrument: Instrument, calibrations: Sequence[Calibration]) -> InstrumentConstant:
    """Group the determinations by line and by epoch and test their agreement."""
    by_line: dict[StationLine, list[Uncertain]] = {}
    by_block: dict[int, list[Calibration]] = {}
    for item in calibrations:
        by_line.setdefault(item.line, []).append(item.value)
        by_block.setdefault(item.block, []).append(item)
    lines = tuple((line, weighted_mean(items)) for line, items in by_line.items())
    epochs = [
        (_epoch_name(number, by_block), weighted_mean([item.value for item in by_block[number]]))
        for number in sorted(by_block)
    ]
    same_lines = all({item.line for item in items} == set(by_line) for items in by_block.values())
    known = None
    if instrument.known_constant is not None:
        value, sigma = instrument.known_constant
        known = Uncertain(value, {Source("known constant", instrument.id): sigma})
    of_lines = compare_groups([(str(line), mean) for line, mean in lines])
    of_epochs = compare_groups(epochs) if same_lines else None
    pooled = None
    if calibrations:
        pooled = weighted_mean([item.value for item in calibrations])
        pooled = with_disagreement(pooled, instrument.id, of_lines, of_epochs)
    return InstrumentConstant(
        instrument=instrument,
        calibrations=tuple(calibrations),
        lines=lines,
        line_agreement=of_lines,
        phase_agreement=of_epochs,
        known=known,
        pooled=pooled,
    )


def with_disagreement(
    mean: Uncertain, instrument: str, lines: Agreement | None, epochs: Agreement | None
) -> Uncertain:
    """A mean of determinations with the disagreement of lines and epochs in its sigma."""
    for name, test in (("lines", lines), ("epochs", epochs)):
        if test is not None and not test.agree and test.scatter > 0.0:
            source = Source("constant instability", instrument, float(test.dof), name)
            mean = mean.with_part(source, test.scatter)
    return mean


def _epoch_name(number: int, blocks: Mapping[int, Sequence[Calibration]]) -> str:
    """before, after, or the place of a block between surveys."""
    phase = blocks[number][0].phase
    between = [n for n in sorted(blocks) if blocks[n][0].phase == "between"]
    return said("between {index}", index=between.index(number) + 1) if phase == "between" else phase


@dataclass(frozen=True, slots=True)
class Chosen:
    """The constant for one survey session: value, the choice in words, warnings."""

    value: Uncertain | None
    choice: str | None
    warnings: tuple[ResultWarning, ...] = ()


def choose(
    constant: InstrumentConstant,
    choice: ConstantChoice,
    *,
    moment: float | None,
    block: int,
    distance_to: Callable[[str], float | None],
    where: str,
) -> Chosen:
    """The constant that a survey session uses.

    Parameters
    ----------
    constant : InstrumentConstant
    choice : ConstantChoice
        Not running, which is made elsewhere, as is what is predicted for each line: who asks for
        that here has too few determinations.
    moment : float or None
        When the survey session took place.
    block : int
        Number of survey sessions before it.
    distance_to : callable
        Distance [m] from the survey station to the station of a name.
    where : str
        The session, for messages.

    Raises
    ------
    SurveyError
        If the choice names a line on which the instrument was not calibrated, or is no choice.
    """
    if choice.kind == "line":
        return Chosen(_named_line(constant, choice, where), str(choice))
    if choice.kind == "known" or (not constant.calibrations and constant.known is not None):
        if constant.known is None:
            raise SurveyError(_unknown_choice(constant, choice, where))
        return Chosen(constant.known, "known")
    if choice.kind == "predicted":
        return _not_predicted(constant, where)
    if not constant.calibrations:
        return Chosen(None, None)
    if choice.kind == "interpolated":
        return _interpolated(constant, moment, where, block=block)
    if choice.kind == "nearest":
        return _nearest(constant, distance_to, where)
    if constant.instrument.constant_choice is None and constant.set_ups < LEAST_PREDICTED:
        return Chosen(with_archive(constant), "pooled")
    return Chosen(constant.pooled, "pooled")


def _not_predicted(constant: InstrumentConstant, where: str) -> Chosen:
    if not (count := constant.set_ups):
        return Chosen(None, None)
    text = counted(
        "{where}: the constant of {id} cannot be predicted from {count} determination: all are "
        "pooled with their stated sigmas",
        "{where}: the constant of {id} cannot be predicted from {count} determinations: all are "
        "pooled with their stated sigmas",
        count=count,
        where=where,
        id=constant.instrument.id,
    )
    return Chosen(with_archive(constant), "pooled", (ResultWarning("prediction_impossible", text),))


ARCHIVE_SOURCE = said("constant: scatter in the archive")


def with_archive(constant: InstrumentConstant) -> Uncertain | None:
    """The pooled constant with what it scattered by in the archive, where one was learned from.

    Too few determinations tell nothing of their scatter; that the constant stands still between
    them and the line is then known from other campaigns of the instrument only.
    """
    priors = constant.instrument.priors
    if constant.pooled is None or priors is None or not priors.scatter:
        return constant.pooled
    # of the mean of all set-ups and of the line itself
    part = priors.scatter * math.sqrt(1.0 + 1.0 / constant.set_ups)
    dof = float(max(priors.sessions - 1, 1))
    return constant.pooled.with_part(Source(ARCHIVE_SOURCE, constant.instrument.id, dof), part)


def _named_line(constant: InstrumentConstant, choice: ConstantChoice, where: str) -> Uncertain:
    for line, value in constant.lines:
        if line == choice.line:
            return value
    raise SurveyError(_unknown_choice(constant, choice, where))


def _unknown_choice(constant: InstrumentConstant, choice: ConstantChoice, where: str) -> Problem:
    known = [f"{LINE}{line}" for line, _ in constant.lines]
    if constant.known is not None:
        known.append("known")
    return Problem(
        what="the constant asked for does not exist",
        where=said(
            "{where}, instrument {id}, constant_choice", where=where, id=constant.instrument.id
        ),
        found=str(choice),
        expected=", ".join(["predicted", "pooled", "interpolated", "nearest", *known]),
        hint="Name a line with a calibration session, written station-target.",
    )


def _nearest(
    constant: InstrumentConstant, distance_to: Callable[[str], float | None], where: str
) -> Chosen:
    distances = {
        item.line: distance
        for item in constant.calibrations
        if (distance := distance_to(item.station)) is not None
    }
    if not distances:
        text = said(
            "{where}: no positions tell which calibration line is nearest: all are pooled",
            where=where,
        )
        warning = ResultWarning("nearest_unknown", text)
        return Chosen(constant.pooled, "pooled", (warning,))
    nearest = min(distances, key=distances.__getitem__)
    return Chosen(dict(constant.lines)[nearest], f"nearest ({LINE}{nearest})")


def _interpolated(
    constant: InstrumentConstant, moment: float | None, where: str, *, block: int
) -> Chosen:
    """Linear in time between the nearest calibrations before and after (physics.md 3.2)."""
    numbers = {item.block for item in constant.calibrations}
    nearest = {
        "before": max((n for n in numbers if n <= block), default=None),
        "after": min((n for n in numbers if n > block), default=None),
    }
    groups = {
        phase: [item for item in constant.calibrations if item.block == number]
        for phase, number in nearest.items()
    }
    if moment is None or not all(groups.values()):
        return _not_interpolated(constant, where)
    means, moments = {}, {}
    for phase, items in groups.items():
        stamps = [item.moment for item in items if item.moment is not None]
        if len(stamps) != len(items):
            return _not_interpolated(constant, where)
        means[phase] = weighted_mean([item.value for item in items])
        moments[phase] = math.fsum(stamps) / len(stamps)
    span = moments["after"] - moments["before"]
    if span <= 0.0:
        return _not_interpolated(constant, where)
    fraction = (moment - moments["before"]) / span
    value = combine([(1.0 - fraction, means["before"]), (fraction, means["after"])])
    test = constant.line_agreement
    if test is not None and not test.agree and test.scatter > 0.0:
        source = Source("constant instability", constant.instrument.id, float(test.dof), "lines")
        value = value.with_part(source, test.scatter)
    return Chosen(value, "interpolated")


def _not_interpolated(constant: InstrumentConstant, where: str) -> Chosen:
    text = said(
        "{where}: the constant cannot be interpolated: it needs calibrations "
        "before and after, and times, dates or order on every session; all "
        "determinations are pooled",
        where=where,
    )
    return Chosen(constant.pooled, "pooled", (ResultWarning("interpolation_impossible", text),))


__all__ = [
    "SHARED",
    "Agreement",
    "Calibration",
    "Chosen",
    "InstrumentConstant",
    "agreement_text",
    "choose",
    "compare_groups",
    "determine",
]
