"""Gyro azimuths of one line and epoch: what may be compared with each other as repetitions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from surveyapp.core.orientation.sequence import SessionOrder
from surveyapp.core.statistics.repeated import RunScatter, run_scatter
from surveyapp.core.swing.session import ReducedSession
from surveyapp.core.uncertain import Uncertain, aligned
from surveyapp.domain.project import Project
from surveyapp.languages import said

Groups = Mapping[tuple[str, str, str], Sequence[Uncertain]]
"""By station, target and epoch."""
OWN_SCATTER = said("scatter of determinations")
"""Name of the error of determinations whose sigma is that of their scatter."""


def run_groups(project: Project, reduced: Sequence[ReducedSession], instrument: str) -> Groups:
    """Repetitions of one instrument: a drift between epochs is not scatter."""
    order = SessionOrder.of(project, instrument)
    groups: dict[tuple[str, str, str], list[Uncertain]] = {}
    for item in reduced:
        if item.session.instrument != instrument:
            continue
        for target in item.targets:
            if target.gyro_azimuth is not None:
                phase: str = item.session.purpose
                if phase == "calibration":
                    phase = said("block {id}", id=order.block(item.session.id))
                key = (item.session.station, target.target, phase)
                groups.setdefault(key, []).append(target.gyro_azimuth)
    return groups


def scatter_of(groups: Groups) -> RunScatter:
    """Scatter between the runs of one line and epoch.

    Determinations that have their sigma from their scatter contain it already.
    """
    return run_scatter(
        [
            aligned(group)
            for group in groups.values()
            if not any(source.name == OWN_SCATTER for item in group for source in item.parts)
        ]
    )
