"""Tilt log and compass log of a session: what they move, what they check, what is refused."""

import datetime as dt
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.api.sensor_record import sensor_sections
from surveyapp.core.sensors.declination import model_declination
from surveyapp.errors import SurveyError
from tests.sensors.test_levelling import project

TILT_CARD = """id = "t"
title = "t"
kind = "{kind}"
source = "dividing head"
valid_to = {valid}
temperature_c = [0.0, 30.0]
""" + "".join(
    f'[parameter.{name}_{axis}]\nvalue = {value}\nsigma = {sigma}\nunit = "1"\n'
    for axis in ("along", "across")
    for name, value, sigma in (("zero", 5.0, 0.5), ("scale", 2.0, 0.0), ("cross", 0.0, 0.0))
)
COMPASS_CARD = """id = "c"
title = "c"
kind = "compass"
source = "swing"
[constants]
heading_sigma_deg = 0.1
""" + "".join(
    f'[parameter.deviation_{letter}]\nvalue = 0.0\nsigma = 0.1\nunit = "deg"\n'
    for letter in "ABCDE"
)


def session(
    folder: Path, *, valid: str = "2030-01-01", kind: str = "tilt", start: float = 0.0,
    log: str = "T", temperature: float = 20.0, declination: str = "", card: bool = True,
    day: str = "2026-05-01",
) -> Path:  # fmt: skip
    more = f'levelling = {{ log = "{log}", card = "t.toml" }}\n'
    more += f"date = {day}\n" if day else ""
    more += (
        f'pre_orientation = {{ log = "C", card = "c.toml"{declination}, circle = "10-00-00" }}\n'
    )
    more += '[[sensor_log]]\nid = "T"\nkind = "tilt"\nfile = "t.csv"\n'
    more += '[[sensor_log]]\nid = "C"\nkind = "compass"\nfile = "c.csv"\n'
    made = project(folder, [], more=more)
    book = (made / "s.csv").read_text().splitlines()
    timed = [line.replace(",,", f",,{60.0 * k}", 1) for k, line in enumerate(book[1:])]
    (made / "s.csv").write_text("\n".join([book[0], *timed]) + "\n")
    if card:
        (made / "t.toml").write_text(TILT_CARD.format(kind=kind, valid=valid))
    (made / "c.toml").write_text(COMPASS_CARD)
    # true tilt 12" along, 30" across: the card reads 5 + 2 x true
    rows = [f"{start + 10.0 * k},29.0,65.0,{temperature}" for k in range(80)]
    head = "time_s,tilt_along_arcsec,tilt_across_arcsec,temperature_c\n"
    (made / "t.csv").write_text(head + "\n".join(rows) + "\n")
    angle = np.radians(0.1)
    field = f"{20.0 * np.cos(angle)},{20.0 * np.sin(angle)},-40.0,0.0,0.0,9.81"
    head = "time_s,mag_x_uT,mag_y_uT,mag_z_uT,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2\n"
    (made / "c.csv").write_text(head + "\n".join(f"{k},{field}" for k in range(20)) + "\n")
    return made


def test_a_calibrated_log_moves_the_line_as_level_rows_do(tmp_path: Path) -> None:
    found = api.orient(session(tmp_path / "a")).to_dict()
    own = found["sessions"][0]
    assert own["levelling"]["across_arcsec"] == pytest.approx(30.0)
    assert own["levelling"]["along_arcsec"] == pytest.approx(12.0)
    assert own["levelling_correction_arcsec"] == pytest.approx(10.919, abs=5e-4)
    assert own["levelling"]["sigma_arcsec"] == pytest.approx(0.5)
    assert "levelling" in [row["source"] for row in found["lines"][0]["budget"]]


@pytest.mark.parametrize("wrong", [{"valid": "2026-01-01"}, {"temperature": 35.0}])
def test_where_the_card_does_not_hold_nothing_is_applied(
    tmp_path: Path, wrong: dict[str, str]
) -> None:
    folder = session(tmp_path / "a", **wrong)  # type: ignore[arg-type]
    check = next(c for c in api.check(folder) if c.rule == "levelling.card_valid")
    assert check.passed is False
    assert api.orient(folder).to_dict()["sessions"][0]["levelling_correction_arcsec"] is None


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        ({"log": "X"}, "there is no such sensor log"),
        ({"kind": "rate"}, "the card is of another kind"),
        ({"start": 1e5}, "no sample during the session"),
        ({"card": False}, "t.toml"),
    ],
)
def test_what_cannot_be_used_is_told(tmp_path: Path, wrong: dict[str, str], text: str) -> None:
    with pytest.raises(SurveyError, match=text):
        api.orient(session(tmp_path / "a", **wrong))  # type: ignore[arg-type]


def test_a_model_declination_never_passes_ten_minutes(tmp_path: Path) -> None:
    folder = session(tmp_path / "a", declination=", declination_deg = 0.0")
    aimed = api.orient(folder).to_dict()["sessions"][0]["pre_orientation"]
    assert abs(aimed["offset_deg"]) == pytest.approx(0.1, abs=1e-6)
    assert 0.31 <= aimed["declination_sigma_deg"] <= 0.5
    assert aimed["turn_to_deg"] == pytest.approx(10.0 - aimed["offset_deg"])
    checks = {c.rule: c for c in api.check(folder)}
    assert checks["pre_orientation.transit"].passed is False
    assert checks["pre_orientation.tracking"].passed is True


def test_a_magnetic_heading_alone_says_nothing_of_north(tmp_path: Path) -> None:
    checks = {c.rule: c for c in api.check(session(tmp_path / "a", day="2031-06-01"))}
    assert checks["pre_orientation.tracking"].passed is None


def test_without_a_stated_declination_the_model_serves_for_place_and_day(tmp_path: Path) -> None:
    """Latitude 47, longitude 9, 2026-05-01; beyond the five years of the model it is told."""
    pytest.importorskip("pygeomag")
    aimed = api.orient(session(tmp_path / "a")).to_dict()["sessions"][0]["pre_orientation"]
    value, sigma = model_declination(
        latitude_deg=47.0, longitude_deg=9.0, height_m=0.0, day=dt.date(2026, 5, 1)
    )
    assert aimed["declination_source"] == "model"
    assert aimed["declination_deg"] == pytest.approx(value)
    assert aimed["declination_sigma_deg"] == pytest.approx(sigma)
    assert aimed["sigma_deg"] >= sigma
    late = api.orient(session(tmp_path / "b", day="2031-06-01")).to_dict()
    assert late["sessions"][0]["pre_orientation"]["declination_deg"] is None
    assert "no_model_declination" in {w["code"] for w in late["warnings"]}
    stated = session(tmp_path / "c", declination=", declination_deg = 0.5, sigma_deg = 0.4")
    aimed = api.orient(stated).to_dict()["sessions"][0]["pre_orientation"]
    assert aimed["declination_source"] == "stated"


def test_the_place_of_the_model_comes_through_the_grid(tmp_path: Path) -> None:
    """Longitude 9 is the central meridian of EPSG:25832: e = 500 km; n of latitude 47."""
    pytest.importorskip("pygeomag")
    known = session(tmp_path / "a", day="")
    book = (known / "s.csv").read_text().splitlines()
    timed = [line.replace(",,", ",2026-05-01T08:00:00+02:00,", 1) for line in book[1:2]]
    (known / "s.csv").write_text("\n".join([book[0], *timed, *book[2:]]) + "\n")
    project = known / "project.toml"
    stated = api.orient(known).to_dict()["sessions"][0]["pre_orientation"]
    text = project.read_text()
    assert "lat = 47.0\nlon = 9.0\n" in text
    grid = text.replace("lat = 47.0\nlon = 9.0\n", "e = 500000.0\nn = 5205164.11\n", 1)
    project.write_text(grid.replace("format = 1\n", 'format = 1\ncrs = "EPSG:25832"\n'))
    found = api.orient(known).to_dict()["sessions"][0]["pre_orientation"]
    assert found["declination_source"] == "model"
    # the day stands in the book alone, the place in the grid alone
    assert found["declination_deg"] == pytest.approx(stated["declination_deg"], abs=1e-4)


def test_the_rows_say_what_was_levelled_and_where_to_turn_the_alidade(tmp_path: Path) -> None:
    from surveyapp.report.sections.session_sensors import blocks
    from surveyapp.report.text import blocks_text
    from surveyapp_models.angles import AngleUnit

    stated = ", declination_deg = 0.5, sigma_deg = 0.4"
    item = api.orient(session(tmp_path / "a", declination=stated)).sessions[0]
    text = blocks_text(blocks(item, AngleUnit.DMS), 100)
    assert '+12.00"' in text  # the tilt that the log was made with
    assert '+30.00"' in text
    assert '+10.92"' in text  # exact rotation, levelling.md
    aimed = item.pre_orientation
    assert aimed is not None
    # magnetic heading 0.1, declination 0.5: the alidade is 36' east of north, circle 10 degrees
    assert "+36.0'" in text
    assert "-36.0'" in text
    assert "9-24-00" in text
    # .4 and .1 degrees: 24.7' (1 sigma), with 1.96 of them 84.5' and no method is served
    assert "24.7'" in text
    assert "not within 60' (tracking), not within 10' (transit)" in " ".join(text.split())


def test_without_a_declination_nothing_is_said_of_north(tmp_path: Path) -> None:
    from surveyapp.report.sections.session_sensors import pre_orientation_rows
    from surveyapp_models.angles import AngleUnit

    item = api.orient(session(tmp_path / "a", day="2031-06-01")).sessions[0]
    rows = pre_orientation_rows(item.pre_orientation, AngleUnit.DMS)
    assert len(rows) == 2
    assert rows[1][1] == "-"


def test_readings_beyond_the_card_are_told_and_a_rest_is_no_dead_axis(tmp_path: Path) -> None:
    """The log reads 65 arcsec across and never changes: the instrument stands."""
    folder = session(tmp_path / "p")
    card = folder / "t.toml"
    text = card.read_text()
    for largest, code in (("", "range_unknown"), ("50.0", "beyond_range"), ("65.0", "")):
        constants = f"[constants]\nlargest_reading_arcsec = {largest}\n" if largest else ""
        card.write_text(text + constants)
        told = {w.code for w in api.open_project(folder).warnings}
        assert told & {"range_unknown", "beyond_range", "never_changes"} == (
            {code} if code else set()
        )


def test_a_compass_tilted_beyond_its_card_gives_no_heading(tmp_path: Path) -> None:
    folder = session(tmp_path / "p", declination=", declination_deg = 2.0, sigma_deg = 0.1")
    log = folder / "c.csv"
    iron = {f"hard_iron_{a}": 0.0 for a in "xyz"}
    iron |= {f"soft_iron_{a}{b}": float(a == b) for a, b in ("xx", "yy", "zz", "xy", "xz", "yz")}
    unit = "".join(
        f'[parameter.{name}]\nvalue = {value}\nsigma = 0.0\nunit = "1"\n'
        for name, value in iron.items()
    )
    head = COMPASS_CARD.split("[parameter.")[0].replace("0.1\n", "0.1\nlargest_tilt_deg = 3.0\n")
    (folder / "c.toml").write_text(head + unit)
    head, *rows = log.read_text().splitlines()
    for tilt_deg, sure in ((5.0, False), (1.0, True)):
        force = f"{9.81 * np.sin(np.radians(tilt_deg))},0.0,{9.81 * np.cos(np.radians(tilt_deg))}"
        made = [",".join([*row.split(",")[:4], force]) for row in rows]
        log.write_text("\n".join([head, *made]) + "\n")
        found = api.open_project(folder).sessions[0].pre_orientation
        assert found is not None
        assert (found.heading is not None) is sure
        assert bool(found.refusals) is not sure


def test_logs_of_a_session_are_not_calibrated_in_the_record(tmp_path: Path) -> None:
    """A level log has no reference: each was called unfit on the first page."""
    made = sensor_sections(api.compute(session(tmp_path / "r")))
    assert [extra.verdict for extra in made] == ["used by a session"] * 2
    assert "card t.toml" in str(made[0].blocks)
