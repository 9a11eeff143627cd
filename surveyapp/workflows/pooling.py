"""All runs and campaigns of one instrument, in one project or an archive of projects.

Runs are pooled: what no single one says. Campaigns teach how often each cause is at work in this
instrument and how large it is. Each project is a task of its own, for any executor.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.prediction.learning import Evidence, evidence_of, learned
from surveyapp.core.swing.sights import tripod_twist
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.later_visits import campaign_data
from surveyapp.diagnosis.pooling import Pooled, PooledEffect, pool
from surveyapp.diagnosis.subjects.campaign import campaign
from surveyapp.diagnosis.subjects.choice import determinations, is_run, run_problem
from surveyapp.domain.instrument import Instrument
from surveyapp.domain.priors import BASE, UNITS, Priors
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, joined, listed, said, sentence, some, term
from surveyapp.languages.names import named

LEAST_CAMPAIGN = 4
"""Determinations from which a campaign teaches anything."""
LEAST_RUN = 6
STRENGTH = 20.0
"""Campaigns that the default priors count for beside those of an archive."""
MOST_TOLD = 8


@dataclass(frozen=True, slots=True)
class Wanted:
    """The instrument that is looked for: by its serial where both have one, else by its id."""

    id: str
    serial: str

    def matches(self, other: Instrument) -> bool:
        """Whether it is the same instrument."""
        if self.serial and other.serial:
            return self.serial == other.serial
        return self.id == other.id


@dataclass(frozen=True, slots=True)
class Part:
    """What one project gives.

    Parameters
    ----------
    path : str
    found : bool
        Whether the instrument is in it.
    runs : tuple of Case
    campaign : Evidence or None
    left_out : tuple of str
        Sessions that could not be used, and why; or why the project could not.
    """

    path: str
    found: bool
    runs: tuple[Case, ...] = ()
    campaign: Evidence | None = None
    left_out: tuple[str, ...] = ()


def part_of(path: str, orientation: Orientation, wanted: Wanted) -> Part:
    """Runs and campaign of one instrument in one project."""
    project = orientation.project
    own = [item for item in project.instruments if wanted.matches(item)]
    runs: list[Case] = []
    left_out: list[str] = []
    for session in project.sessions:
        if session.instrument not in {item.id for item in own} or not is_run(session):
            continue
        sights = [
            target.sights
            for item in orientation.sessions
            if item.session.id == session.id
            for target in item.targets
            if target.sights is not None
        ]
        try:
            case = run_problem(
                session,
                project.instrument(session.instrument).card,
                latitude=orientation.positions[session.station].latitude,
                twist=tripod_twist(sights),
            )
        except SurveyError as error:
            left_out.append(f"{path}, {error.problems[0]}")
            continue
        if case.size < LEAST_RUN:
            left_out.append(f"{path}, session {session.id}: only {case.size} turning points")
        else:
            runs.append(case)
    evidence = _campaign(orientation, own[0].id) if own else None
    return Part(path, bool(own), tuple(runs), evidence, tuple(left_out))


def _campaign(orientation: Orientation, instrument: str) -> Evidence | None:
    """What the determinations of a project say of the causes; None where they are too few."""
    constant = next(c for c in orientation.constants if c.instrument.id == instrument)
    if constant.set_ups < LEAST_CAMPAIGN or constant.instrument.effects:
        return None
    try:
        case = campaign(determinations(orientation, instrument), instrument=instrument)
    except SurveyError:
        return None
    rows = np.arange(case.size)
    return evidence_of(campaign_data(case, rows, np.eye(case.size)[:1]))


@dataclass(frozen=True, slots=True)
class InstrumentDiagnosis:
    """What all records of an instrument say together.

    Parameters
    ----------
    instrument : Wanted
    projects : int
        In which it was found.
    pooled : Pooled or None
        None without runs.
    campaigns : int
    priors : Priors or None
        Learned from the campaigns; None without any.
    warnings : tuple of ResultWarning
    written : str
        Where the priors were written, or empty.
    """

    instrument: Wanted
    projects: int
    pooled: Pooled | None
    campaigns: int
    priors: Priors | None
    warnings: tuple[ResultWarning, ...]
    written: str = ""

    @property
    def verdict(self) -> str:
        """As of any diagnosis."""
        if self.pooled is None or not self.pooled.fired:
            return "adequate"
        return "explained" if self.pooled.named is not None else "not_separable"

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.diagnose/1``."""
        named = None if self.pooled is None else self.pooled.named
        best = self._best()
        return {
            "schema": "surveyapp.diagnose/1",
            "subject": "instrument",
            "instrument": self.instrument.id,
            "serial": self.instrument.serial or None,
            "unit": "arcsec",
            "verdict": self.verdict,
            "adopted": [] if named is None else [_effect(named)],
            "pooled": None
            if self.pooled is None
            else {
                "effect": None if best is None else best.effect,
                "coefficient": None if best is None else best.coefficient,
                "sigma": None if best is None else best.sigma,
                "unit": None if best is None else best.unit,
                "sessions": len(self.pooled.sessions),
                "named": named is not None,
                "effects": [_effect(item) for item in self.pooled.effects],
            },
            "projects": self.projects,
            "campaigns": self.campaigns,
            "priors": None
            if self.priors is None
            else {
                "shares": {unit: round(self.priors.share(unit), 5) for unit in UNITS},
                "sizes": [round(size, 5) for size in self.priors.sizes],
                "sessions": self.priors.sessions,
                "origin": self.priors.origin,
            },
            "written": [self.written] if self.written else [],
            "words": self.words(),
            "warnings": [warning.to_dict() for warning in self.warnings],
        }

    def _best(self) -> PooledEffect | None:
        if self.pooled is None:
            return None
        if self.pooled.named is not None:
            return self.pooled.named
        return next((e for e in self.pooled.effects if e.coefficient is not None), None)

    def words(self) -> list[str]:
        """The result in plain sentences."""
        words = []
        if self.pooled is None:
            words.append(said("No run of this instrument can be pooled."))
        else:
            words += _pooled_words(self.pooled)
        if self.priors is not None:
            words.append(_learned(self.priors, self.campaigns))
        words += [sentence(w.text) for w in self.warnings]
        if self.written:
            words.append(said("The priors are in {place}.", place=self.written))
        return words


def _effect(item: PooledEffect) -> dict[str, Any]:
    return {
        "effect": item.effect,
        "evidence": round(item.evidence, 3),
        "p": item.p,
        "coefficient": item.coefficient,
        "sigma": item.sigma,
        "unit": item.unit or None,
        "sessions": item.sessions,
    }


def _pooled_words(pooled: Pooled) -> list[str]:
    count = len(pooled.sessions)
    runs = counted("{count} run together", "{count} runs together", count=count)
    if pooled.named is not None:
        e = pooled.named
        return [
            said(
                "{runs} name {effect}: {coefficient:.3g} {unit} (sigma {sigma:.1g}), "
                "p = {p:.3f}; every rival is at least 2 nats less likely.",
                runs=runs,
                effect=term(e.title.lower()),
                coefficient=e.coefficient,
                unit=term(e.unit),
                sigma=e.sigma,
                p=e.p,
            )
        ]
    if not pooled.fired:
        return [
            said(
                "{runs} show no effect of the instrument that noise does not show as well.",
                runs=runs,
            )
        ]
    near = [
        term(e.title.lower())
        for e in pooled.effects
        if e.evidence > pooled.effects[0].evidence - 2.0
    ]
    names = listed(near[:4])
    return [
        said("{runs} are more than noise; {names} cannot be told apart.", runs=runs, names=names)
    ]


def _learned(priors: Priors, campaigns: int) -> str:
    """What the campaigns let expect of the next one."""
    return said(
        "{campaigns} with {count} determinations: nothing but noise is taken for likely in "
        "{noise:.0%} of the next ones; where something is at work it is mostly {likeliest}.",
        campaigns=counted("{count} campaign", "{count} campaigns", count=campaigns),
        count=priors.sessions,
        noise=priors.share(BASE),
        likeliest=_likeliest(priors),
    )


def _likeliest(priors: Priors) -> str:
    order = sorted((u for u in UNITS if u != BASE), key=lambda u: -priors.share(u))
    shares = [joined(" ", (named(u), f"({priors.share(u):.0%})")) for u in order[:3]]
    return joined(", ", shares)


def diagnose_parts(
    wanted: Wanted, parts: Iterable[Part], rng: np.random.Generator
) -> InstrumentDiagnosis:
    """Pool the runs and learn from the campaigns of many projects.

    Raises
    ------
    SurveyError
        If none of them has a run or a campaign of the instrument.
    """
    every = list(parts)
    own = [part for part in every if part.found]
    runs = [case for part in own for case in part.runs]
    campaigns = [part.campaign for part in own if part.campaign is not None]
    if not runs and not campaigns:
        raise SurveyError(_nothing(wanted, every))
    priors = None
    if campaigns:
        origin = f"{len(campaigns)} campaigns of {wanted.serial or wanted.id}"
        priors = learned(campaigns, origin=origin, strength=STRENGTH)
    return InstrumentDiagnosis(
        wanted,
        len(own),
        pool(runs, rng) if runs else None,
        len(campaigns),
        priors,
        tuple(_warnings(wanted, every)),
    )


def _nothing(wanted: Wanted, parts: Sequence[Part]) -> Problem:
    return Problem(
        "nothing of this instrument can be pooled",
        "diagnose --instrument",
        counted(
            "{serial} in {count} project",
            "{serial} in {count} projects",
            serial=wanted.serial or wanted.id,
            count=len(parts),
        ),
        said(
            "a run of {least_run} turning points or {least_campaign} determinations",
            least_run=LEAST_RUN,
            least_campaign=LEAST_CAMPAIGN,
        ),
        "Name the instrument by its id; projects of an archive are matched by its serial.",
    )


def _warnings(wanted: Wanted, parts: Sequence[Part]) -> list[ResultWarning]:
    found = []
    strange = [part.path for part in parts if not part.found and not part.left_out]
    if strange:
        text = said(
            "not of {serial}, left out: {names}",
            serial=wanted.serial or wanted.id,
            names=some(strange, 3),
        )
        found.append(ResultWarning("other_instrument", text))
    left = [text for part in parts for text in part.left_out]
    found += [ResultWarning("left_out", text) for text in left[:MOST_TOLD]]
    if len(left) > MOST_TOLD:
        found.append(
            ResultWarning(
                "left_out", said("{value} more were left out", value=len(left) - MOST_TOLD)
            )
        )
    return found
