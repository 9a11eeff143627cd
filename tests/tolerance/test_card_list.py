"""The instrument cards that an office expects, and what they may not hold."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveyapp.io.cards import installed_card_ids, read_card
from surveyapp_models.angles import RHO_ARCSEC

EXPECTED = {
    "wild-gak1",
    "fennel-kt1",
    "mom-gi-b1",
    "mom-gi-b2",
    "mom-gi-b3",
    "mvt-2",
    "jt-15",
    "sokkia-gp",
    "gyromat-2000",
    "gyromat-3000",
    "gyromat-5000",
    "hgg05",
    "er-gt-02",
    "sokkia-gp3130r3",
    "gyromax-ak-2m",
    "gyro-x-ii",
    "gat-05",
}
# One azimuth [arcsec] as the sources print it: 1 c, 80 cc, 0.8 mgon, 3.6", 5", 20".
AZIMUTH = {
    "wild-gak1": 32.4,
    "fennel-kt1": 80 * 0.324,
    "gyromat-2000": 0.8 * 3.24,
    "gyromat-3000": 0.8 * 3.24,
    "gyromat-5000": 0.8 * 3.24,
    "er-gt-02": 3.6,
    "hgg05": 5.0,
    "sokkia-gp3130r3": 20.0,
}


def test_every_instrument_of_the_trade_has_a_card() -> None:
    assert set(installed_card_ids()) >= EXPECTED


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_a_card_has_a_source_and_holds_nothing_that_it_calls_unknown(name: str) -> None:
    card = read_card(name, base=Path(), override={})
    assert card.source
    if "values" in dict(card.notes):
        assert (card.scale_value, card.periods, card.sigma.azimuth) == (None, None, None)


@pytest.mark.parametrize(("name", "arcsec"), AZIMUTH.items())
def test_accuracies_are_those_printed(name: str, arcsec: float) -> None:
    sigma = read_card(name, base=Path(), override={}).sigma.azimuth
    assert sigma is not None
    assert sigma * RHO_ARCSEC == pytest.approx(arcsec)
