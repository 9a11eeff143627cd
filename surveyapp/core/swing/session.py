"""One occupation of a station: method, sights, set-up, to the gyro azimuth of each target."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from surveyapp.core.book.resolution import reading_resolution, rounding_sigma
from surveyapp.core.checks.blunders import refuse_wrong_faces
from surveyapp.core.swing.automatic import azimuth_targets, reduce_automatic
from surveyapp.core.swing.clamped_north import reduce_nontracking
from surveyapp.core.swing.classical_transit import is_classical, reduce_classical
from surveyapp.core.swing.goodness import Judge
from surveyapp.core.swing.levelling import Tilt, session_tilt, sight_correction, steepness
from surveyapp.core.swing.reduction import Reduction
from surveyapp.core.swing.run_model import RunModel
from surveyapp.core.swing.sights import (
    SightSet,
    TripodTwist,
    eccentric_correction,
    reduce_sights,
    zenith_angle,
)
from surveyapp.core.swing.tracking import reduce_tracking
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession, Station, grid_distance_m
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import either, said
from surveyapp_models.angles import wrap_two_pi

ESTIMATORS: Mapping[str, tuple[str, ...]] = {
    "tracking": ("least-squares", "schuler"),
    "amplitude": ("least-squares", "amplitude"),
    "transit": ("least-squares", "transit"),
    "automatic": ("mean",),
}
"""Estimators by method; the first is the default (tracking: from six turning points on)."""
ECCENTRIC_SIGMA_M = 0.001
"""Of an eccentric offset that states no sigma: read on a millimetre scale, as centring is."""
LEAST_COLLIMATIONS = 4
"""Set-ups from which the scatter of the collimation has three degrees of freedom."""


@dataclass(frozen=True, slots=True)
class SightSigma:
    """Standard deviation of one pointing [rad], its degrees of freedom and its origin."""

    value: float
    dof: float
    origin: str


@dataclass(frozen=True, slots=True)
class TargetReduction:
    """One target of a reduced session.

    Parameters
    ----------
    target : str
    sights : SightSet or None
        None where the instrument delivered the azimuth.
    line_reading : Uncertain or None
        B with the eccentric correction in it [rad].
    eccentric : float
        That correction [rad].
    gyro_azimuth : Uncertain or None
        A_g = B - N [rad]; None without gyro north.
    levelling : float or None
        What the tilt of the standing axis adds to the line reading (it is in it) [rad]; None
        without level readings of both axes.
    """

    target: str
    sights: SightSet | None
    line_reading: Uncertain | None
    eccentric: float
    gyro_azimuth: Uncertain | None
    levelling: float | None = None


@dataclass(frozen=True, slots=True)
class ReducedSession:
    """A session after everything that needs no other session."""

    session: OrientationSession
    reduction: Reduction
    targets: tuple[TargetReduction, ...]
    warnings: tuple[ResultWarning, ...]

    def levelling_of(self, target: str) -> float | None:
        """What level readings have added to the line reading of a target [rad], None without."""
        return next((t.levelling for t in self.targets if t.target == target), None)


def estimator_for(session: OrientationSession, estimator: str | None) -> str | None:
    """Check that an estimator asked for suits the session's method.

    Raises
    ------
    SurveyError
        If it does not; an automatic gyro knows no estimator and takes none.
    """
    if estimator is None or session.method == "automatic":
        return None
    allowed = ESTIMATORS[session.method]
    if estimator in allowed:
        return estimator
    raise SurveyError(
        Problem(
            what=said(
                "the estimator {estimator} does not suit the method {method}",
                estimator=estimator,
                method=session.method,
            ),
            where=said("session {id}", id=session.id),
            found=estimator,
            expected=either(allowed),
            hint="Choose another estimator, or orient one session alone.",
        )
    )


def reduce_swing(
    session: OrientationSession,
    card: InstrumentCard,
    judge: Judge,
    *,
    latitude: float | None,
    estimator: str | None,
    run_model: RunModel | None = None,
    twist: TripodTwist | None = None,
) -> Reduction:
    """Reduce the observation itself by the session's method, a turning tripod taken out of it.

    ``latitude`` [rad].
    """
    chosen = estimator_for(session, estimator)
    if session.method == "automatic":
        return reduce_automatic(session, card)
    if is_classical(session, card, latitude) and chosen in (None, "transit"):
        return reduce_classical(session, card, latitude=latitude)
    if session.method != "tracking":
        return reduce_nontracking(
            session, card, judge, latitude=latitude, estimator=chosen, twist=twist
        )
    return reduce_tracking(
        session,
        card,
        judge,
        latitude=latitude,
        estimator=chosen,
        run_model=run_model,
        twist=twist,
    )


def sight_targets(session: OrientationSession) -> tuple[str, ...]:
    """Names of all targets of a session, its own first."""
    names = [session.target] if session.target else []
    kinds = (ReadingKind.BACKSIGHT, ReadingKind.AZIMUTH)
    names += [row.target for row in session.book.of_kind(*kinds) if row.target]
    return tuple(dict.fromkeys(names))


def collect_sights(session: OrientationSession) -> dict[str, SightSet]:
    """Reduced sights of every target that was sighted."""
    found = {}
    for target in sight_targets(session):
        sights = reduce_sights(session.book, target, default_target=session.target)
        if sights is not None:
            refuse_wrong_faces(session, sights)
            found[target] = sights
    return found


def pooled_sight_sigma(
    sights: Sequence[SightSet], *, resolution: float, fallback: float | None
) -> SightSigma:
    """Standard deviation of one pointing from all sights of one instrument.

    Parameters
    ----------
    sights : sequence of SightSet
        Of every session of the instrument: collimation and tripod drift differ from set-up to
        set-up and are taken out, the pointing error is one.
    resolution : float
        Reading resolution [rad]; rounding is the floor.
    fallback : float or None
        The card's sigma of a turning point, which contains a circle reading: an upper bound, used
        where the sights have no redundancy. The scatter of the collimation over several set-ups
        is an upper bound as well; the smaller of the two is taken.
    """
    dof = sum(item.dof for item in sights)
    floor = rounding_sigma(resolution)
    if dof > 0:
        sigma = math.sqrt(math.fsum(item.sum_of_squares for item in sights) / dof)
        return SightSigma(max(sigma, floor), float(dof), said("residuals of the sights"))
    scatter = _collimation_scatter(sights)
    if scatter is not None and (fallback is None or scatter.value < fallback):
        return replace(scatter, value=max(scatter.value, floor))
    if fallback is not None:
        return SightSigma(max(fallback, floor), math.inf, said("the card's reading sigma"))
    return SightSigma(floor, math.inf, said("rounding alone"))


def _collimation_scatter(sights: Sequence[SightSet]) -> SightSigma | None:
    """Sigma of one pointing from what the collimation changes from set-up to set-up."""
    found = [
        (item.collimation, item.collimation_cofactor)
        for item in sights
        if item.collimation is not None
    ]
    if len(found) < LEAST_COLLIMATIONS:
        return None
    weights = [1.0 / cofactor for _, cofactor in found]
    mean = math.fsum(w * c for w, (c, _) in zip(weights, found, strict=True)) / math.fsum(weights)
    squares = math.fsum(w * (c - mean) ** 2 for w, (c, _) in zip(weights, found, strict=True))
    dof = len(found) - 1
    return SightSigma(math.sqrt(squares / dof), float(dof), said("scatter of the collimation"))


def sight_resolution(session: OrientationSession) -> float:
    """Resolution of the sights of a session [rad]."""
    if session.resolution is not None:
        return session.resolution
    return reading_resolution(session.book.of_kind(ReadingKind.BACKSIGHT))


def eccentric_of(
    session: OrientationSession, target: str, line_reading: float, stations: Mapping[str, Station]
) -> tuple[float, float]:
    """Eccentric correction of a line reading and the 1-sigma of it [rad].

    Raises
    ------
    SurveyError
        If the distance of the marks is not known, or not longer than the offset.
    """
    eccentric = session.eccentric
    if eccentric is None or eccentric.distance_m == 0.0:
        return 0.0, 0.0
    if eccentric.at == "target" and target != session.target:
        return 0.0, 0.0
    distance = None
    if target in stations:
        distance = grid_distance_m(stations[session.station], stations[target])
    if distance is None or distance <= eccentric.distance_m:
        raise SurveyError(
            Problem(
                what="an eccentric set-up needs the distance of the two marks",
                where=said(
                    "session {id}, line {station}-{target}",
                    id=session.id,
                    station=session.station,
                    target=target,
                ),
                found="no grid positions of both" if distance is None else f"{distance:.3f} m",
                expected=said("a distance above {distance_m:g} m", distance_m=eccentric.distance_m),
                hint="Give e and n (or lat and lon with a crs) of station and target.",
            )
        )
    ratio = eccentric.distance_m / distance
    correction = eccentric_correction(
        line_reading=line_reading, direction=eccentric.direction, ratio=ratio, at=eccentric.at
    )
    sigma = ECCENTRIC_SIGMA_M if eccentric.sigma_m is None else eccentric.sigma_m
    return correction, sigma / distance


def reduce_targets(
    session: OrientationSession,
    reduction: Reduction,
    sights: Mapping[str, SightSet],
    *,
    sigma: SightSigma,
    stations: Mapping[str, Station],
    card: InstrumentCard,
) -> tuple[TargetReduction, ...]:
    """Gyro azimuth of every target of a session."""
    results = []
    if reduction.azimuth is not None:
        for place, target in enumerate(azimuth_targets(session)):
            first = place == 0
            own = reduction.azimuth if first else _azimuth_of(session, card, target)
            correction, spread = _delivered_eccentric(session, target, sights, stations)
            if own is not None:
                own = own.shifted(correction)
                if spread > 0.0:
                    own = own.with_part(Source("eccentricity", session.id), spread)
            results.append(TargetReduction(target, None, None, correction, own))
        return tuple(results)
    tilt = session_tilt(session, tape_zero=False)
    for target, item in sights.items():
        correction, spread = eccentric_of(session, target, item.line_reading, stations)
        level = None
        if tilt is not None:
            level = _levelling(session, (target, item), sights, (tilt, stations))
        source = Source("sights", session.id, sigma.dof, target, pool=session.instrument)
        reading = Uncertain(
            wrap_two_pi(item.line_reading + correction + (level or 0.0)),
            {source: math.sqrt(item.cofactor) * sigma.value},
        )
        if spread > 0.0:
            reading = reading.with_part(Source("eccentricity", session.id), spread)
        azimuth = None if reduction.north is None else reading - reduction.north
        results.append(TargetReduction(target, item, reading, correction, azimuth, level))
    return tuple(results)


def _azimuth_of(session: OrientationSession, card: InstrumentCard, target: str) -> Uncertain | None:
    """Delivered azimuth of a further target."""
    return reduce_automatic(session, card, target=target).azimuth


def _levelling(
    session: OrientationSession,
    sighted: tuple[str, SightSet],
    sights: Mapping[str, SightSet],
    at: tuple[Tilt, Mapping[str, Station]],
) -> float:
    """Correction of a line reading for the tilt of the standing axis [rad].

    Directions count from the session's target, else from the first one sighted.
    """
    target, item = sighted
    tilt, stations = at
    own = sights.get(session.target or "", next(iter(sights.values())))
    zenith = zenith_angle(session.book, target, default_target=session.target)
    return sight_correction(
        tilt,
        direction=item.line_reading - own.line_reading,
        cotangent=steepness(session, target, stations, zenith),
    )


def _delivered_eccentric(
    session: OrientationSession,
    target: str,
    sights: Mapping[str, SightSet],
    stations: Mapping[str, Station],
) -> tuple[float, float]:
    """Eccentric correction of a delivered azimuth: it needs the circle reading of the line."""
    eccentric = session.eccentric
    if eccentric is None or eccentric.distance_m == 0.0:
        return 0.0, 0.0
    if target in sights:
        return eccentric_of(session, target, sights[target].line_reading, stations)
    if eccentric.at == "target" and target != session.target:
        return 0.0, 0.0
    raise SurveyError(
        Problem(
            what="an eccentric set-up of a delivered azimuth needs the circle reading of its line",
            where=said(
                "session {id}, line {station}-{target}",
                id=session.id,
                station=session.station,
                target=target,
            ),
            found="azimuth rows without a backsight of the target",
            expected="a backsight on the circle on which the direction to the mark was read",
            hint="Enter the sights, or the azimuth of the marks itself.",
        )
    )


def known_target(session: OrientationSession, stations: Mapping[str, Station]) -> None:
    """Refuse a sight whose target is no station of the project."""
    for target in sight_targets(session):
        if target not in stations:
            raise SurveyError(
                Problem(
                    what="a sight whose target is no station",
                    where=said("session {id}", id=session.id),
                    found=target,
                    expected="the name of a [[station]]",
                    hint=nearest_names(target, stations),
                )
            )
