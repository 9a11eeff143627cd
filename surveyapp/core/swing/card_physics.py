"""What a card says at the latitude of the station: periods, torsion ratio, transit constant.

The one place where card values are carried to another latitude; the laws stand in
``surveyapp_models.gyro``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from surveyapp.domain.instrument import InstrumentCard
from surveyapp.languages import said
from surveyapp_models.gyro.coefficients import (
    torsion_ratio_from_periods,
    transfer_torsion_ratio,
    transfer_transit_coefficient,
    transit_coefficient_at_latitude,
)
from surveyapp_models.gyro.estimates import Estimate
from surveyapp_models.gyro.periods import transfer_clamped_period, transfer_tracking_period


@dataclass(frozen=True, slots=True)
class CardAt:
    """Card values at one latitude; None where the card cannot tell.

    Parameters
    ----------
    tracking_s, clamped_s, unspun_s : Estimate or None
        T1, T2, T0.
    torsion_ratio : Estimate or None
        lambda.
    torsion_origin : str
        ``lambda`` or ``periods``.
    transit_c : Estimate or None
        C [rad/(div s)].
    transferred : bool
        Whether the values were carried to a latitude other than the card's own.
    """

    tracking_s: Estimate | None
    clamped_s: Estimate | None
    unspun_s: Estimate | None
    torsion_ratio: Estimate | None
    torsion_origin: str
    transit_c: Estimate | None
    transferred: bool


def card_at(card: InstrumentCard, latitude: float | None) -> CardAt:
    """Carry the values of a card to a latitude.

    Parameters
    ----------
    card : InstrumentCard
    latitude : float or None
        [rad]; None: the values at the card's own latitude.
    """
    periods = card.periods
    if periods is None:
        stated = card.torsion_lambda
        own = None if stated is None else Estimate(stated, card.torsion_sigma or 0.0)
        return CardAt(None, None, None, own, "lambda", None, transferred=False)
    at = periods.latitude
    to = at if latitude is None else latitude
    sigma = periods.sigma_s or 0.0

    def measured(value: float | None) -> Estimate | None:
        return None if value is None else Estimate(value, sigma)

    first, second = measured(periods.tracking_s), measured(periods.clamped_s)
    ratio, origin = _ratio(card, first, second)
    c = None
    if card.transit_c is not None and ratio is not None:
        own = Estimate(card.transit_c, card.transit_c_sigma or 0.0)
        c = transfer_transit_coefficient(own, ratio, latitude=at, to_latitude=to)
    elif card.scale_value is not None and first is not None and second is not None:
        c = transit_coefficient_at_latitude(
            first, second, scale_value=card.scale_value, latitude=at, to_latitude=to
        )
    return CardAt(
        tracking_s=None
        if first is None
        else transfer_tracking_period(first, latitude=at, to_latitude=to),
        clamped_s=_clamped_at(first, second, ratio, latitude=at, to_latitude=to),
        unspun_s=measured(periods.unspun_s),
        torsion_ratio=None
        if ratio is None
        else transfer_torsion_ratio(ratio, latitude=at, to_latitude=to),
        torsion_origin=origin,
        transit_c=c,
        transferred=latitude is not None,
    )


def _ratio(
    card: InstrumentCard, first: Estimate | None, second: Estimate | None
) -> tuple[Estimate | None, str]:
    if card.torsion_lambda is not None:
        return Estimate(card.torsion_lambda, card.torsion_sigma or 0.0), "lambda"
    if first is not None and second is not None:
        return torsion_ratio_from_periods(first, second), "periods"
    if card.transit_c is not None and card.scale_value and second is not None:
        # C = (pi/2) mu T1^2/T2^3 and 1 + lambda = T1^2/T2^2
        one_plus = 2.0 * card.transit_c * second.value / (math.pi * card.scale_value)
        return Estimate(one_plus - 1.0, one_plus * second.sigma / second.value), said(
            "transit constant"
        )
    return None, ""


def _clamped_at(
    first: Estimate | None,
    second: Estimate | None,
    ratio: Estimate | None,
    *,
    latitude: float,
    to_latitude: float,
) -> Estimate | None:
    """T2 at a latitude, from T1 and T2, or from T2 and lambda (T1 = T2 sqrt(1 + lambda))."""
    if second is None:
        if first is None or ratio is None:
            return None
        second = Estimate(first.value / (1.0 + ratio.value) ** 0.5, first.sigma)
    if first is None:
        if ratio is None:
            return second
        first = Estimate(second.value * (1.0 + ratio.value) ** 0.5, second.sigma)
    return transfer_clamped_period(second, first, latitude=latitude, to_latitude=to_latitude)
