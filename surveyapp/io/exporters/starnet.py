"""STAR*NET input: points, observations with their sigmas, units and order stated.

Source: MicroSurvey STAR*NET V6 manual, ch. 5: codes C, A, D, B, DB DM DE, V, L, ``.ORDER``,
``.UNITS``, ``.DELTA``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from surveyapp.domain.exported import ExportedSurvey, Written
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, wrap_two_pi

K = ObservationKind
_SPATIAL = frozenset({K.SLOPE_DISTANCE, K.ZENITH, K.HEIGHT_DIFFERENCE})
_LONGEST = 15
"""Characters of a name in STAR*NET."""


def _renamed(names: Sequence[str]) -> dict[str, str]:
    """Names without blanks and hyphens, ASCII, each of its own."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        base = re.sub(r"[^A-Za-z0-9_.]", "_", name)[:_LONGEST] or "P"
        new, number = base, 1
        while new.upper() in taken:
            number += 1
            tail = f"_{number}"
            new = base[: _LONGEST - len(tail)] + tail
        taken.add(new.upper())
        found[name] = new
    return found


class _Writer:
    """Lines of one file; mutable, private to one writing."""

    def __init__(self, survey: ExportedSurvey) -> None:
        self.survey = survey
        names = dict.fromkeys(p.name for p in survey.points)
        for obs in survey.observations:
            names |= dict.fromkeys(name for name in (obs.at, obs.back, obs.to) if name)
        self.names = _renamed(list(names))
        self.spatial = any(obs.kind in _SPATIAL for obs in survey.observations)
        self.delta = False
        self.lines: list[str] = []
        self.lost: dict[str, int] = {}

    def sight(self, *names: str) -> str:
        return "-".join(self.names[name] for name in names)

    def angle(self, value: float) -> str:
        return format_angle(wrap_two_pi(value), AngleUnit.DMS, decimals=3)

    def switch(self, delta: bool) -> None:
        """Horizontal distances and height differences (ON), or slope and zenith (OFF)."""
        if self.spatial and delta != self.delta:
            self.lines.append(f".DELTA {'ON' if delta else 'OFF'}")
            self.delta = delta

    def heights(self, obs: Observation) -> str:
        return f" {obs.hi:.4f}/{obs.ht:.4f}" if self.spatial else ""

    def observation(self, obs: Observation) -> None:
        seconds, metres = f"{obs.sigma * RHO_ARCSEC:.3f}", f"{obs.sigma:.5f}"
        at, to = obs.at, obs.to
        if obs.kind is K.ANGLE:
            line = f"A {self.sight(at, obs.back, to)} {self.angle(obs.value)} {seconds}"
        elif obs.kind is K.AZIMUTH:
            line = f"B {self.sight(at, to)} {self.angle(obs.value)} {seconds}"
        elif obs.kind is K.DISTANCE:
            self.switch(True)
            line = f"D {self.sight(at, to)} {obs.value:.5f} {metres}"
        elif obs.kind is K.SLOPE_DISTANCE:
            self.switch(False)
            line = f"D {self.sight(at, to)} {obs.value:.5f} {metres}{self.heights(obs)}"
        elif obs.kind is K.ZENITH:
            self.switch(False)
            line = f"V {self.sight(at, to)} {self.angle(obs.value)} {seconds}{self.heights(obs)}"
        elif obs.kind is K.HEIGHT_DIFFERENCE:
            self.switch(True)
            line = f"L {self.sight(at, to)} {obs.value - obs.ht + obs.hi:.5f} {metres}"
        else:
            self.lost[str(obs.kind)] = self.lost.get(str(obs.kind), 0) + 1
            return
        self.lines.append(line)

    def directions(self, members: Sequence[Observation]) -> None:
        self.lines.append(f"DB {self.names[members[0].at]}")
        for obs in members:
            seconds = f"{obs.sigma * RHO_ARCSEC:.3f}"
            self.lines.append(f"DM {self.names[obs.to]} {self.angle(obs.value)} {seconds}")
        self.lines.append("DE")

    def points(self) -> None:
        for point in self.survey.points:
            values = [f"{point.e:.4f}", f"{point.n:.4f}"]
            if self.spatial and point.h is not None:
                values.append(f"{point.h:.4f}")
            marks = " !" * len(values) if point.fixed else ""
            self.lines.append(f"C {self.names[point.name]} {' '.join(values)}{marks}")


def starnet_text(survey: ExportedSurvey) -> Written:
    """Points and observations as STAR*NET input."""
    writer = _Writer(survey)
    title = "".join(c if c.isascii() and c.isprintable() else "?" for c in survey.name)
    writer.lines += [
        f"# {title}",
        ".3D" if writer.spatial else ".2D",
        ".UNITS METERS DMS",
        ".ORDER EN ATFROMTO",
    ]
    if writer.spatial:
        writer.lines.append(".DELTA OFF")
    writer.points()
    sets: dict[tuple[str, str], list[Observation]] = {}
    for obs in survey.observations:
        if obs.kind is K.DIRECTION:
            sets.setdefault((obs.at, obs.set), []).append(obs)
    for members in sets.values():
        writer.directions(members)
    for obs in survey.observations:
        if obs.kind is not K.DIRECTION:
            writer.observation(obs)
    count = len(survey.points) + len(survey.observations) - sum(writer.lost.values())
    return Written("\n".join(writer.lines) + "\n", count, _told(writer))


def _told(writer: _Writer) -> tuple[ResultWarning, ...]:
    told = []
    changed = [f"{old} -> {new}" for old, new in writer.names.items() if old != new]
    if changed:
        text = said(
            "names were replaced (no blanks, hyphens or other letters): {names}",
            names=", ".join(changed),
        )
        told.append(ResultWarning("names_replaced", text))
    if writer.lost:
        parts = ", ".join(f"{kind} ({count})" for kind, count in writer.lost.items())
        told.append(
            ResultWarning(
                "observations_left_out", said("the format has no word for: {parts}", parts=parts)
            )
        )
    correlated = [o for o in writer.survey.observations if o.kind is K.AZIMUTH]
    if len(correlated) > 1:
        text = "azimuths are written as independent: a constant that they share is in each of them"
        told.append(ResultWarning("correlation_lost", text))
    return tuple(told)
