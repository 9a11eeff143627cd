"""Sigma of determinations that say nothing of themselves, from their repetition.

A single round of an instrument whose card states no sigma has none. Where one line was observed
again and again, the scatter of the determinations about their mean is the mean square error of
one: m = sqrt([vv] / (n - 1)), over several lines and epochs pooled (physics.md 3.2).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from surveyapp.core.orientation.repeated_runs import OWN_SCATTER, Groups
from surveyapp.core.swing.session import ReducedSession
from surveyapp.core.uncertain import Source, Uncertain, aligned
from surveyapp.domain.project import Project
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC

NAME = OWN_SCATTER


def with_scatter_sigma(
    project: Project, reduced: Sequence[ReducedSession], groups: Mapping[str, Groups]
) -> tuple[tuple[ReducedSession, ...], list[ResultWarning]]:
    """Give determinations without a sigma that of their scatter.

    Parameters
    ----------
    project : Project
    reduced : sequence of ReducedSession
    groups : mapping of instrument to groups
        Gyro azimuths of one line and epoch, for each instrument.
    """
    result = list(reduced)
    warnings: list[ResultWarning] = []
    for instrument in project.instruments:
        found = _scatter(groups[instrument.id].values())
        if found is None:
            continue
        sigma, dof = found
        source = Source(NAME, "", float(dof), pool=instrument.id)
        changed = [
            (place, item)
            for place, item in enumerate(result)
            if item.session.instrument == instrument.id
            and any(_silent(target.gyro_azimuth) for target in item.targets)
        ]
        for place, item in changed:
            own = replace(source, entity=item.session.id)
            targets = tuple(
                replace(t, gyro_azimuth=_told(t.gyro_azimuth, own, sigma)) for t in item.targets
            )
            result[place] = replace(item, targets=targets)
        if changed:
            text = said(
                "{id}: {changed} sessions tell no sigma: that of their scatter is taken, "
                '{sigma:.1f}" for one and, from the scatter alone, {sigma2:.1f}" for the '
                "mean of {changed}, with {dof} degrees of freedom",
                id=instrument.id,
                changed=len(changed),
                sigma=sigma * RHO_ARCSEC,
                sigma2=sigma / math.sqrt(len(changed)) * RHO_ARCSEC,
                dof=dof,
            )
            subject = Subject.of("instrument", instrument.id)
            warnings.append(ResultWarning("sigma_from_scatter", text, subject))
    return tuple(result), warnings


def without_answered(
    measured: Sequence[ReducedSession], told: Sequence[ReducedSession]
) -> tuple[ReducedSession, ...]:
    """Sessions without the warning of an unknown sigma where their scatter has told it."""
    known = {
        item.session.id
        for item in told
        if any(s.name == NAME for t in item.targets if t.gyro_azimuth for s in t.gyro_azimuth.parts)
    }
    return tuple(
        replace(item, warnings=tuple(w for w in item.warnings if w.code != "sigma_unknown"))
        if item.session.id in known
        else item
        for item in measured
    )


def _silent(value: Uncertain | None) -> bool:
    return value is not None and not math.isfinite(value.variance)


def _told(value: Uncertain | None, source: Source, sigma: float) -> Uncertain | None:
    """The value with what nobody knows replaced by the scatter."""
    if value is None or not _silent(value):
        return value
    parts = {own: part for own, part in value.parts.items() if math.isfinite(part)}
    return replace(value, parts=parts | {source: sigma})


def _scatter(groups: Iterable[Sequence[Uncertain]]) -> tuple[float, int] | None:
    """Pooled standard deviation [rad] of silent determinations and its degrees of freedom."""
    squares, dof = 0.0, 0
    for group in groups:
        silent = [item for item in group if _silent(item)]
        if len(silent) < 2:
            continue
        silent = aligned(silent)
        mean = math.fsum(item.value for item in silent) / len(silent)
        squares += math.fsum((item.value - mean) ** 2 for item in silent)
        dof += len(silent) - 1
    return (math.sqrt(squares / dof), dof) if dof and squares > 0.0 else None
