"""Sigmas from repetition, sigmas that nothing tells, and constants from few determinations."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from surveyapp import api
from tests.api.projects import TM, azimuths, session, station, write

GYRO = '[[instrument]]\nid = "G1"\ncard = "card.toml"\n{more}\n'
SILENT = """
id = "silent"
title = "Automatic gyro of unknown sigma"
kind = "automatic"
source = "invented for a test"
"""
STATED = SILENT + "[sigma]\nazimuth_arcsec = 4.0\n"
PLACES = "".join(
    station(name, e=0.0, n=n)
    for name, n in (("K", 5500000.0), ("L", 5500500.0), ("A", 5501000.0), ("B", 5501500.0))
)
KNOWN = ("azimuth_known = 0.0", "azimuth_known_sigma_arcsec = 1.0")


def oriented(
    folder: Path, calibrations: tuple[float, ...], *, card: str = STATED, more: str = ""
) -> api.OrientationResult:
    """One session a calibration [arcsec], then one of a line."""
    toml, books = GYRO.format(more=more) + PLACES, {}
    for number, value in enumerate(calibrations):
        own = ('purpose = "calibration"', f"order = {number}", *KNOWN)
        toml += session(f"c{number}", "K", "L", more=own)
        books[f"c{number}"] = azimuths(f"{value / 3600.0:.9f}")
    toml += session("u", "A", "B", more=('purpose = "survey"', "order = 99"))
    books["u"] = azimuths("0.01")
    head = TM + 'angle_unit = "deg"\ncentring_mm = { instrument = 0.0, target = 0.0 }\n'
    return api.orient(write(folder, toml, books, card=card, head=head))


def told(result: api.OrientationResult, code: str) -> list[str]:
    return [str(warning.text) for warning in result.warnings if warning.code == code]


def test_the_scatter_of_silent_determinations_is_their_sigma(tmp_path: Path) -> None:
    # vv of 10, 20, 30, 60 about 30 is 1400: sqrt(1400 / 3) = 21.6 for one, 10.8 for the mean of 4
    result = oriented(tmp_path, (10.0, 20.0, 30.0, 60.0), card=SILENT)
    (text,) = told(result, "sigma_from_scatter")
    one = math.sqrt(1400.0 / 3.0)
    # the single sight of the line tells no scatter, but gets it: five sessions
    assert "G1: 5 sessions tell no sigma" in text
    assert f'{one:.1f}" for one' in text
    assert f'{one / math.sqrt(5.0):.1f}" for the mean of 5' in text
    assert "with 3 degrees of freedom" in text
    assert not told(result, "sigma_unknown")


def test_one_silent_determination_says_that_nothing_tells_its_sigma(tmp_path: Path) -> None:
    result = oriented(tmp_path, (10.0,), card=SILENT)
    texts = told(result, "sigma_unknown")
    assert sorted(texts) == [
        f"session {name}: neither the scatter of the rounds nor the card tells a sigma"
        for name in ("c0", "u")
    ]
    assert not told(result, "sigma_from_scatter")


@pytest.mark.parametrize(
    ("count", "more", "wanted"),
    [
        (1, "", "rests on 1 determination and its stated sigma;"),
        (3, "", "rests on 3 determinations and their stated sigmas;"),
        (4, "", None),  # predicted, with what they show
        (3, 'constant = { arcsec = 0.0, sigma_arcsec = 3.0 }\nconstant_choice = "known"', None),
    ],
)
def test_few_determinations_do_not_show_what_changes_a_constant(
    tmp_path: Path, count: int, more: str, wanted: str | None
) -> None:
    result = oriented(tmp_path, (10.0, 12.0, 9.0, 11.0)[:count], more=more)
    texts = told(result, "few_determinations")
    assert len(texts) == (wanted is not None)
    if wanted is not None:
        assert texts[0].startswith("instrument G1: its constant")
        assert wanted in texts[0]


def test_assumed_sigmas_stand_on_the_budget_with_their_source(tmp_path: Path) -> None:
    result = oriented(tmp_path, (10.0, 12.0))
    (line,) = result.lines
    rows = {row.source: row for row in line.budget}
    assert "assumed 5 mm" in rows["known azimuth"].origin
    assert '5" and 20 km' in rows["deflection"].origin
    zero = {row.source for row in line.budget if row.sigma == 0.0}
    assert {"levelling", "graduation", "twist", "lateral refraction", "observer"} <= zero
