"""Interference lines in the samples of a rate sensor's stops, which the means of stops cannot show.

Of each stretch what it is known to hold is taken out: its mean, and on a table that turns the
earth rate, which comes round once a turn. What is left of each gyro is searched for lines.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.sensors.linear import alternate_blocks
from surveyapp.core.sensors.rate.adopted import StopDatum, without_effects
from surveyapp.diagnosis.long_records.interference import find_interference
from surveyapp.diagnosis.long_records.lines import LEAST_FILLED, SpectralLine
from surveyapp.diagnosis.result import Adoption, CandidateResult, Diagnosis, NamedCoefficient
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.line_spectrum import InterferenceLine
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.languages import term
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.rate import DEG_S
from surveyapp_models.effects.rate.interference_line import EFFECT

LINE_ALARM = 0.01
"""Probability of a false line in a log (``python -m bench rate_line_alarm``)."""
WAYS = 2
"""A line shows by itself or in a family: two looks."""
NOTCH = 4.0
"""Cycles over a stretch within which its mean takes noise out. With 4 false alarms hold in every
layout and noise (``bench rate_line_alarm``); 1 gave .09 of 150 records at rest in low-pass noise.
The price (``bench rate_line_constants``): a line at one and a half times a total station's turn
is found in .03 instead of .66."""
MOST_LINES = 12
"""Of one gyro; more are an image of something that is no line."""
BLOCK_S = 10.0
"""Length of the blocks that are left out in turn."""
BROKEN = 0.2
"""Share of a sample by which a gap may miss whole samples before the grid begins anew."""
LEAST_PART = 0.3
"""Of the longest part: shorter ones are not searched, each would cost all of them."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Rows of a stop: first, last (exclusive), and the rate of the table [rad/s], 0 = at rest."""

    first: int
    last: int
    rate: float = 0.0


@dataclass(frozen=True, slots=True)
class LineFound:
    """One line of one gyro.

    Parameters
    ----------
    gyro : str
    line : SpectralLine
    cosine, sine : float
        [rad/s]
    before, after : float
        Scatter of samples that had no part in the fit, without and with the line [rad/s].
    lasts_s : float
        Time from the first sample to the last.
    begin_s : float
        Time of the first sample, where the phase is zero.
    """

    gyro: str
    line: SpectralLine
    cosine: float
    sine: float
    before: float
    after: float
    lasts_s: float
    begin_s: float


@dataclass(frozen=True, slots=True)
class LineJudgement:
    """Lines of all gyros, smallest probability of a false alarm, and why none was looked for."""

    lines: tuple[LineFound, ...]
    p: float | None
    reason: str = ""


def judge_lines(
    time_s: Floats, columns: Sequence[Floats], stretches: Sequence[Stretch], gyros: Sequence[str]
) -> LineJudgement:
    """Search the samples of all stretches, one gyro after the other.

    Parameters
    ----------
    time_s : ndarray, shape (n,)
    columns : sequence of ndarray, shape (n,)
        Outputs [rad/s].
    stretches : sequence of Stretch
    gyros : sequence of str
        Their names.
    """
    found: list[LineFound] = []
    reason, smallest, searched = "", 1.0, []
    for gyro, values in zip(gyros, columns, strict=True):
        every = np.full(values.size, np.nan)
        for stretch in stretches:  # neighbours may share a sample
            every[stretch.first : stretch.last] = _left(time_s, values, stretch)
        rows = np.flatnonzero(np.isfinite(every))
        searched += [(gyro, every[part], time_s[part]) for part in _even_parts(time_s, rows)]
    slowest = _slowest_hz(time_s, stretches)
    for gyro, left, here in searched:
        more, p, why = _one_by_one(gyro, here, left, parts=len(searched), slowest_hz=slowest)
        found, smallest, reason = found + more, min(smallest, p), why or reason
    if reason and not found:
        return LineJudgement((), None, reason)
    kept = [one for one in found if one.after < one.before]
    return LineJudgement(_once_each(kept), smallest)


def _slowest_hz(time_s: Floats, stretches: Sequence[Stretch]) -> float:
    """Frequency from which on the samples of levelled stretches hold their noise unchanged.

    Below, the mean of each and what comes round once a turn are out of them: a notch as wide as a
    stretch is short, on whose edge the noise would look like a line.
    """
    lasts = np.array([time_s[s.last - 1] - time_s[s.first] for s in stretches])
    turns = np.array([abs(s.rate) / (2.0 * math.pi) for s in stretches])
    return float(np.median(turns + NOTCH / np.maximum(lasts, 1e-9))) if lasts.size else 0.0


def _one_by_one(
    gyro: str, time_s: Floats, left: Floats, *, parts: int, slowest_hz: float
) -> tuple[list[LineFound], float, str]:
    """Lines of one part of a gyro's samples, the strongest first and out before the next.

    A record with pauses shows every line many times over, as far from it as the pauses are
    frequent; these images go with the line itself.

    Returns
    -------
    lines : list of LineFound
    p : float
        Smallest probability of a false alarm, over all ``parts`` that are searched.
    reason : str
        Why nothing could be searched, else empty.
    """
    found: list[LineFound] = []
    smallest = 1.0
    for _ in range(MOST_LINES):
        seen = find_interference(time_s, left, slowest_hz=slowest_hz)
        if seen.unsearched:
            return found, smallest, seen.unsearched
        looks = WAYS * parts
        told = [_told(n, min(1.0, n.false_alarm_probability * looks)) for n in seen.lines]
        if not found:
            smallest = min((n.false_alarm for n in told), default=1.0)
        clear = [n for n in told if n.false_alarm <= LINE_ALARM]
        if not clear:
            break
        one = _proved(gyro, max(clear, key=lambda n: n.amplitude), time_s, left)
        found.append(one)
        phase = 2.0 * math.pi * one.line.frequency * (time_s - time_s[0])
        left = left - one.cosine * np.cos(phase) - one.sine * np.sin(phase)
    return found, smallest, ""


def _told(line: InterferenceLine, p: float) -> SpectralLine:
    return SpectralLine(
        line.frequency_hz, line.sigma_hz, line.amplitude, line.sigma_amplitude, p, EFFECT.id
    )


def _even_parts(time_s: Floats, rows: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Rows that lie on one even grid each: where sampling began anew, its phase did too."""
    if rows.size < 2:
        return [rows]
    gaps = np.diff(time_s[rows])
    steps = gaps / float(np.median(gaps))
    breaks = np.flatnonzero(np.abs(steps - np.rint(steps)) > BROKEN)
    step = float(np.median(gaps))
    parts = [one for part in np.split(rows, breaks + 1) for one in _filled(time_s, part, step)]
    longest = max(part.size for part in parts)
    return [part for part in parts if part.size > LEAST_PART * longest]


def _filled(time_s: Floats, rows: NDArray[np.intp], step: float) -> list[NDArray[np.intp]]:
    """Parts of which samples fill at least half, cut at the longest pauses between turns."""
    length = float(time_s[rows[-1]] - time_s[rows[0]]) if rows.size else 0.0
    if rows.size < 2 or rows.size >= LEAST_FILLED * (length / step + 1.0):
        return [rows]
    cut = int(np.argmax(np.diff(time_s[rows]))) + 1
    return [*_filled(time_s, rows[:cut], step), *_filled(time_s, rows[cut:], step)]


def _once_each(found: Sequence[LineFound]) -> tuple[LineFound, ...]:
    """Of a line that several parts of a gyro's record show, the surest."""
    kept: list[LineFound] = []
    for one in sorted(found, key=lambda f: f.line.false_alarm):
        same = [
            k
            for k in kept
            if k.gyro == one.gyro
            and abs(k.line.frequency - one.line.frequency) < 2.0 / max(k.lasts_s, 1e-9)
        ]
        if not same:
            kept.append(one)
    return tuple(sorted(kept, key=lambda f: (f.gyro, f.line.frequency)))


def _left(time_s: Floats, values: Floats, stretch: Stretch) -> Floats:
    """Samples of a stretch without its mean and what comes round once a turn."""
    rows = slice(stretch.first, stretch.last)
    columns = [np.ones(stretch.last - stretch.first)]
    if stretch.rate != 0.0:
        angle = stretch.rate * (time_s[rows] - time_s[stretch.first])
        columns += [np.cos(angle), np.sin(angle)]
    design = np.column_stack(columns)
    return np.asarray(values[rows] - design @ np.linalg.lstsq(design, values[rows], rcond=None)[0])


def _proved(gyro: str, line: SpectralLine, time_s: Floats, values: Floats) -> LineFound:
    """The line fitted to one half of the blocks and taken from the other, in turn."""
    phase = 2.0 * math.pi * line.frequency * (time_s - time_s[0])
    design = np.column_stack([np.cos(phase), np.sin(phase)])
    whole = np.linalg.lstsq(design, values, rcond=None)[0]
    step = float(np.median(np.diff(time_s)))
    rest = np.zeros(values.size)
    for used, held in alternate_blocks(values.size, max(round(BLOCK_S / step), 1)):
        part = np.linalg.lstsq(design[used], values[used], rcond=None)[0]
        rest[held] = values[held] - design[held] @ part
    return LineFound(
        gyro,
        line,
        float(whole[0]),
        float(whole[1]),
        float(np.std(values)),
        float(np.std(rest)),
        float(time_s[-1] - time_s[0]),
        float(time_s[0]),
    )


def with_lines_of(found: Diagnosis, judged: LineJudgement) -> Diagnosis:
    """A diagnosis of stops with the lines of their samples."""
    verdict = CandidateResult(
        EFFECT.id,
        "not_applicable"
        if judged.p is None
        else ("adopted" if judged.lines else "not_significant"),
        judged.p,
        judged.p,
        None,
        "named",
        judged.reason,
    )
    others = tuple(c for c in found.candidates if c.effect != EFFECT.id)
    named = tuple(_adoption(one, found) for one in judged.lines)
    explained = found.verdict == "adequate" and bool(named)
    return replace(
        found,
        verdict="explained" if explained else found.verdict,
        candidates=(*others, verdict),
        adopted=(*found.adopted, *named),
        lines=(*found.lines, *(one.line for one in judged.lines)),
        remedy=(*found.remedy, term(EFFECT.remedy)) if named else found.remedy,
        frequency_unit="Hz",
    )


def _adoption(one: LineFound, found: Diagnosis) -> Adoption:
    sigma = one.line.sigma_amplitude / DEG_S
    named = (
        NamedCoefficient(f"cosine_{one.gyro}", one.cosine / DEG_S, sigma, "deg/s"),
        NamedCoefficient(f"sine_{one.gyro}", one.sine / DEG_S, sigma, "deg/s"),
    )
    record = AdoptedEffect(
        id=EFFECT.id,
        coefficients=tuple((c.name, c.value, c.sigma or 0.0, c.unit) for c in named),
        grid=(
            ("frequency_hz", one.line.frequency),
            ("begin_s", one.begin_s),
            ("end_s", one.begin_s + one.lasts_s),
        ),
        data_sha256=str(found.ledger.get("data_sha256", "")),
        before=one.before / DEG_S,
        after=one.after / DEG_S,
        unit="deg/s",
    )
    grid = (("frequency_hz", one.line.frequency, "Hz"),)
    return Adoption(EFFECT.id, EFFECT.title, named, grid, one.line.false_alarm, None, record)


def with_lines_beside(
    found: Diagnosis,
    *,
    log: SensorLog,
    columns: Mapping[str, str],
    stretches: Sequence[Stretch],
    datum: StopDatum,
) -> tuple[Diagnosis, dict[str, Any]]:
    """A diagnosis of stops with the lines of their samples, what it named taken out of these.

    A field that is switched, a drift within a stop would else stand as lines of its own.

    Parameters
    ----------
    found : Diagnosis
    log : SensorLog
    columns : mapping of str to str
        Gyro to its column.
    stretches : sequence of Stretch
    datum : StopDatum
    """
    named = [replace(a.record, data_sha256="") for a in found.adopted]
    clean, _ = without_effects(log, named, datum)
    values = [clean.columns[c] for c in columns.values()]
    judged = judge_lines(log.columns["time_s"], values, stretches, tuple(columns))
    return with_lines_of(found, judged), interference_dict(judged)


def interference_dict(judged: LineJudgement) -> dict[str, Any]:
    """Key ``interference`` of the JSON: scatter of samples of the half that was left out."""
    return {
        "interference": [
            {
                "gyro": one.gyro,
                "frequency_hz": one.line.frequency,
                "held_out": {
                    "before": one.before / DEG_S,
                    "after": one.after / DEG_S,
                    "unit": "deg/s",
                },
            }
            for one in judged.lines
        ]
    }
