"""A campaign as a problem: repeated constants or azimuths of one instrument over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.orientation.campaign_columns import (
    BLOCK_GAP_DAYS,
    COLUMNS,
    LABELLED,
    block_names,
)
from surveyapp.core.orientation.circumstances import Circumstances, columns_of, numbered
from surveyapp.diagnosis.action import POSITION, Action, last_rows
from surveyapp.diagnosis.case import Case
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect

NOTHING_TOLD = Circumstances(None, {})


@dataclass(frozen=True, slots=True)
class CampaignDetermination:
    """One determination of a constant (or of one azimuth).

    Parameters
    ----------
    value : float
        [rad].
    sigma : float or None
        [rad]; without any the determinations are taken for equally good.
    circumstances : Circumstances
        What the columns of a campaign say of it (``Circumstances.of({...})``).
    label : str
        For messages.
    subject : Subject or None
        The session and target that it comes from.
    """

    value: float
    sigma: float | None = None
    circumstances: Circumstances = NOTHING_TOLD
    label: str = ""
    subject: Subject | None = None

    @classmethod
    def at(
        cls,
        value: float,
        sigma: float | None = None,
        *,
        order: float | None = None,
        **columns: float | str | None,
    ) -> CampaignDetermination:
        """A determination with its circumstances by the names of their columns.

        Parameters
        ----------
        value : float
            [rad].
        sigma : float or None
            [rad].
        order : float or None
            Stands in for time where there is no date.
        columns : float, str or None
            Each in the unit of its column.
        """
        return cls(value, sigma, Circumstances.of(columns, order))

    @property
    def day(self) -> float | None:
        """Days since any zero, None where it has no date."""
        return self.circumstances.number("elapsed_days")


TEMPERATURE_STEP_K = 8.0


def _after(columns: Mapping[str, Floats], days: float) -> dict[str, Floats]:
    """The last determination again, some days later, in a block of work of its own."""
    row = last_rows(columns)
    row[POSITION] = row[POSITION] + days
    if "elapsed_days" in row:
        row["elapsed_days"] = row["elapsed_days"] + days
    if "block" in row and days >= BLOCK_GAP_DAYS:
        row["block"] = np.array([columns["block"].max() + 1.0])
    return row


def _now(columns: Mapping[str, Floats], /) -> dict[str, Floats]:
    return _after(columns, 0.04)


def _tomorrow(columns: Mapping[str, Floats], /) -> dict[str, Floats]:
    return _after(columns, 1.0)


def _in_a_month(columns: Mapping[str, Floats], /) -> dict[str, Floats]:
    return _after(columns, 30.0)


def _heated(columns: Mapping[str, Floats], step: float) -> dict[str, Floats] | None:
    theta = columns.get("temperature_c")
    if theta is None or not np.isfinite(theta).all():
        return None
    return {**_after(columns, 1.0), "temperature_c": theta[-1:] + step}


def _warmer(columns: Mapping[str, Floats], /) -> dict[str, Floats] | None:
    return _heated(columns, TEMPERATURE_STEP_K)


def _colder(columns: Mapping[str, Floats], /) -> dict[str, Floats] | None:
    return _heated(columns, -TEMPERATURE_STEP_K)


def _other_line(columns: Mapping[str, Floats], /) -> dict[str, Floats] | None:
    """A known line that is not the last one: the one that was used least, else a new one."""
    line = columns.get("line")
    if line is None:
        return None
    row = _after(columns, 0.04)
    names, counts = np.unique(line[line != line[-1]], return_counts=True)
    chosen = float(names[np.argmin(counts)]) if names.size else float(line.max()) + 1.0
    row["line"] = np.array([chosen])
    there = np.flatnonzero(line == chosen)
    for name in (column.name for column in COLUMNS if column.of_line):
        if there.size and name in columns:
            row[name] = columns[name][there[-1:]]
    return row


ACTIONS = (
    Action("repeat", said("repeat the determination now"), _now),
    Action("tomorrow", said("repeat it tomorrow"), _tomorrow),
    Action("warmer", said("determine it 8 K warmer"), _warmer),
    Action("colder", said("determine it 8 K colder"), _colder),
    Action("other_line", said("determine it on another known line"), _other_line),
    Action("month", said("determine it in 30 days"), _in_a_month),
)


def campaign(
    determinations: Sequence[CampaignDetermination],
    *,
    instrument: str = "",
    reference_temperature_c: float | None = None,
    resolution: float = 0.0,
    extra: tuple[Effect, ...] = (),
) -> Case:
    """Make the problem of a campaign.

    Parameters
    ----------
    determinations : sequence of CampaignDetermination
    instrument : str
    reference_temperature_c : float, optional
    resolution : float
        Of the determinations [rad]; 0 = unknown.
    extra : tuple of Effect
        The user's own effects.

    Returns
    -------
    Case

    Raises
    ------
    SurveyError
        If there are fewer than two determinations, or some have a sigma and others have none.
    """
    _check(determinations, instrument)
    values = np.array([d.value for d in determinations])
    n = values.size
    sigmas = [d.sigma for d in determinations]
    sigma = None if any(s is None for s in sigmas) else np.array(sigmas, dtype=np.float64)
    columns, labels, warnings = _columns(determinations)
    position = columns.get("elapsed_days", np.arange(n, dtype=np.float64))
    if position.size > 1 and np.ptp(position) == 0.0:
        position = np.arange(n, dtype=np.float64)
    weights = np.full(n, 1.0 / n)
    if sigma is not None:
        weights = sigma**-2 / float(np.sum(sigma**-2))
    references = {}
    if reference_temperature_c is not None:
        references["temperature_c"] = reference_temperature_c
    if sigma is None:
        warnings.append(
            ResultWarning("no_sigmas", said("no stated sigmas: all determinations count the same"))
        )
    offset = float(np.median(values))
    return Case(
        subject="campaign",
        title=said("campaign"),
        value_name=said("the constant"),
        actions=ACTIONS,
        observations=values - offset,
        base=np.ones((n, 1)),
        base_names=("constant",),
        value_base=np.ones(1),
        value_weights=weights,
        position=position,
        columns=columns,
        effects=(*of_subject("campaign"), *extra),
        sigma=sigma,
        weighted=sigma is not None,
        resolution=resolution,
        references=references,
        offset=offset,
        instrument=instrument,
        identity=said("campaign of {instrument}", instrument=instrument)
        if instrument
        else "campaign",
        members=tuple(d.subject for d in determinations if d.subject is not None),
        labels=tuple(
            d.label or said("determination {i}", i=i + 1) for i, d in enumerate(determinations)
        ),
        grid_labels=labels,
        warnings=tuple(warnings),
        position_unit="d" if all(d.day is not None for d in determinations) else "",
    )


def _check(determinations: Sequence[CampaignDetermination], instrument: str) -> None:
    faults = []
    where = said("campaign of {instrument}", instrument=instrument) if instrument else "campaign"
    if len(determinations) < 2:
        faults.append(
            Problem(
                "too few determinations for a campaign",
                where,
                str(len(determinations)),
                "at least 2; from 8 on an effect can be named",
            )
        )
    with_sigma = sum(d.sigma is not None for d in determinations)
    if 0 < with_sigma < len(determinations):
        faults.append(
            Problem(
                "some determinations have a sigma and others have none",
                where,
                f"{with_sigma} of {len(determinations)}",
                "all or none",
            )
        )
    if any(d.sigma is not None and not d.sigma > 0.0 for d in determinations):
        faults.append(Problem("a sigma is not positive", where, "", "sigmas above 0"))
    if not all(np.isfinite(d.value) for d in determinations):
        faults.append(Problem("a determination is no number", where, "nan", "angles"))
    few = len(determinations) < 6 and with_sigma < len(determinations)
    if few and len(determinations) >= 2:
        faults.append(
            Problem(
                "too few determinations to judge their scatter, and no stated sigmas",
                where,
                str(len(determinations)),
                "a sigma for each, or at least 6 determinations",
                "Give the card's sigma of one determination.",
            )
        )
    if faults:
        raise SurveyError(faults)


def _columns(
    determinations: Sequence[CampaignDetermination],
) -> tuple[dict[str, Floats], dict[str, dict[float, str]], list[ResultWarning]]:
    """Columns that say something, the names behind numbers, and what stands in for the time."""
    facts = [d.circumstances for d in determinations]
    dated = all(d.day is not None for d in determinations)
    columns: dict[str, Floats] = {}
    labels: dict[str, dict[float, str]] = {}
    warnings: list[ResultWarning] = []
    for name, values in columns_of(facts).items():
        names = [fact.name(name) for fact in facts] if name in LABELLED else []
        if name == "block" and not all(names) and dated:
            names = [*block_names([d.day for d in determinations])]
        if name in LABELLED and all(names):
            columns[name], labels[name] = numbered(names)
        elif name == "elapsed_days":
            if np.isfinite(values).all():
                columns[name] = values
        elif name not in LABELLED and np.isfinite(values).any():
            columns[name] = values
    if not dated:
        warnings.append(
            ResultWarning(
                "no_dates",
                said(
                    "dates are missing or all the same: the order of the determinations stands "
                    "for time"
                )
                if "elapsed_days" in columns
                else said("dates and order are missing: effects of time cannot be judged"),
            )
        )
    return columns, labels, warnings
