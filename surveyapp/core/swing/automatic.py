"""Rounds of an automatic gyro: it delivers azimuths of the line, or circle readings of north.

A book that holds only the printed mean of several rounds says so with ``rounds`` (and
``sigma_arcsec``) in its session.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.core.book.resolution import reading_resolution
from surveyapp.core.swing.gyrofit import unwrap
from surveyapp.core.swing.reduction import Reduction, need_points, reading_sigma, unit_scatter
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import Reading, ReadingKind
from surveyapp.domain.results import PointResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, wrap_two_pi


def stated_rounds(session: OrientationSession) -> int | None:
    """Number of rounds behind a printed mean, None where the book holds the rounds themselves."""
    value = dict(session.override).get("rounds")
    return value if isinstance(value, int) and not isinstance(value, bool) and value > 0 else None


def stated_sigma(session: OrientationSession) -> float | None:
    """Sigma [rad] stated for the session's mean, None without."""
    value = dict(session.override).get("sigma_arcsec")
    if isinstance(value, int | float) and not isinstance(value, bool) and value > 0:
        return float(value) * ARCSEC
    return None


def azimuth_targets(session: OrientationSession) -> tuple[str, ...]:
    """Targets whose azimuth the gyro delivered, the session's own first."""
    rows = session.book.of_kind(ReadingKind.AZIMUTH)
    names = dict.fromkeys(row.target or session.target or "" for row in rows)
    own = session.target
    return tuple(sorted(filter(None, names), key=lambda name: name != own))


def reduce_automatic(
    session: OrientationSession, card: InstrumentCard, *, target: str | None = None
) -> Reduction:
    """Mean of the rounds of an automatic gyro.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
    target : str or None
        Whose delivered azimuths are meant, None for the session's own target, else the first.

    Raises
    ------
    SurveyError
        If there is no round, or if the book mixes delivered azimuths and circle readings of north.
    """
    kind, rows = rounds_of(session, target)
    readings = np.array([row.value for row in rows], dtype=np.float64)
    offsets = unwrap(readings)
    mean = float(offsets.mean())
    residuals = offsets - mean
    dof = readings.size - 1
    rounds = stated_rounds(session) or readings.size
    sigma = reading_sigma(
        count=readings.size,
        variance=float(residuals @ residuals) / dof if dof else None,
        dof=dof,
        card_sigma=card.sigma.azimuth,
        resolution=session.resolution or reading_resolution(rows),
    )
    stated = stated_sigma(session)
    source = Source(
        "rounds",
        session.id,
        sigma.dof if stated is None else math.inf,
        _target_of(session, target),
    )
    contribution = sigma.value / math.sqrt(rounds) if stated is None else stated
    value = Uncertain(float(readings[0]) + mean, {source: contribution})
    origin = sigma.origin if stated is None else "card"
    return Reduction(
        estimator="mean",
        north=value if kind is ReadingKind.NORTH else None,
        azimuth=value if kind is ReadingKind.AZIMUTH else None,
        points_used=rounds,
        dof=dof,
        sigma_source=origin,
        reading_sigma=sigma.value if math.isfinite(sigma.value) else None,
        residual_rms=math.sqrt(float(residuals @ residuals) / readings.size) if dof else None,
        points=_points(rows, wrap_two_pi(value.value), residuals.tolist()),
        warnings=_warnings(session, origin),
        unit=unit_scatter("rounds", sigma) if stated is None else None,
    )


def _target_of(session: OrientationSession, target: str | None) -> str:
    """Whose delivered azimuths are meant."""
    return target or next(iter(azimuth_targets(session)), session.target or "")


def rounds_of(
    session: OrientationSession, target: str | None
) -> tuple[ReadingKind, tuple[Reading, ...]]:
    """The rounds of the session and what they deliver: azimuths of one target, or north.

    Raises
    ------
    SurveyError
        If there are none of the target, or rounds of both kinds.
    """
    kinds = [
        kind for kind in (ReadingKind.AZIMUTH, ReadingKind.NORTH) if session.book.of_kind(kind)
    ]
    need_points(session, found=len(kinds), needed=1, kind="azimuth or north")
    if len(kinds) > 1:
        raise SurveyError(
            Problem(
                what="an automatic gyro delivers either azimuths of the line or readings of north",
                where=said("session {id}, {book_path}", id=session.id, book_path=session.book_path),
                found="rows of both kinds",
                expected="azimuth rows, or north rows with sights",
                hint="Make two sessions of it.",
            )
        )
    kind, wanted = kinds[0], _target_of(session, target)
    rows = tuple(
        row
        for row in session.book.of_kind(kind)
        if kind is ReadingKind.NORTH or (row.target or session.target or "") == wanted
    )
    need_points(session, found=len(rows), needed=1, kind=f"{kind.value} (target {wanted})")
    return kind, rows


def _points(
    rows: Sequence[Reading], mean: float, residuals: Sequence[float]
) -> tuple[PointResult, ...]:
    return tuple(
        PointResult(
            seq=row.seq,
            index=i,
            side="",
            observed=float(row.value if row.value is not None else math.nan),
            fitted=mean,
            residual=residual,
            elapsed_s=row.elapsed_s,
        )
        for i, (row, residual) in enumerate(zip(rows, residuals, strict=True))
    )


def _warnings(session: OrientationSession, origin: str | None) -> tuple[ResultWarning, ...]:
    if origin is not None:
        return ()
    text = said(
        "session {id}: neither the scatter of the rounds nor the card tells a sigma", id=session.id
    )
    return (ResultWarning("sigma_unknown", text),)
