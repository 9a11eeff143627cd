"""Every format in every unit gives the same traverse: the mean of the faces observed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.formats import field_writers as w
from tests.formats.importing import bring, check_rows, rows

GON5 = 0.9e-5
SETUPS, SIGHTS = w.simulated()


@pytest.mark.parametrize("width", [8, 16])
@pytest.mark.parametrize(
    ("angle", "tolerance"), [("gon", GON5), ("deg", 1e-5), ("mil", 1e-5), ("dms", 3e-5)]
)
def test_gsi_in_every_angular_unit(
    tmp_path: Path, width: int, angle: str, tolerance: float
) -> None:
    folder, result = bring(tmp_path, "gsi", w.gsi(SETUPS, SIGHTS, width=width, angle=angle))
    check_rows(folder, SIGHTS, tolerance, 6e-4)
    assert result.variant == f"GSI-{width}, station blocks"
    assert {s.name: s.state for s in result.stations} == dict.fromkeys(
        ("101", "102", "103", "104", "105"), "added"
    )
    place = next(s for s in result.stations if s.name == "103")
    assert (place.e, place.n, place.h) == pytest.approx((1080.123, 1994.544, -313.5), abs=6e-4)


@pytest.mark.parametrize(
    ("length", "tolerance"),
    [("m", 6e-4), ("m4", 6e-5), ("m5", 6e-6), ("ft", 2e-4), ("ft4", 2e-5)],
)
def test_gsi_in_every_unit_of_length(tmp_path: Path, length: str, tolerance: float) -> None:
    folder, result = bring(tmp_path, "gsi", w.gsi(SETUPS, SIGHTS, width=16, length=length))
    check_rows(folder, SIGHTS, GON5, tolerance)
    assert ("foot" in {x.code for x in result.warnings}) == length.startswith("ft")


@pytest.mark.parametrize("pair", ["0008+000", "00000008+0000000", "000000000008+034"])
def test_ppm_and_prism_are_split_at_the_second_sign(tmp_path: Path, pair: str) -> None:
    width = 8 if len(pair) == 8 else 16
    folder, _ = bring(tmp_path, "gsi", w.gsi(SETUPS, SIGHTS, width=width, pair=pair))
    raw = rows(folder / "imports" / "main.raw.csv")
    assert {row["ppm"] for row in raw} == {"8"}
    assert {row["prism_mm"] for row in raw} == {"34" if pair.endswith("34") else "0"}


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends_and_blank_lines_change_nothing(tmp_path: Path, end: str) -> None:
    lines = w.gsi(SETUPS, SIGHTS)
    lines[5:5] = ["", "   "]
    folder, _ = bring(tmp_path, "gsi", [end.join(lines)])
    check_rows(folder, SIGHTS, GON5, 6e-4)


def test_all_blocks_on_one_line(tmp_path: Path) -> None:
    folder, _ = bring(tmp_path, "gsi", ["".join(w.gsi(SETUPS, SIGHTS, width=16))])
    check_rows(folder, SIGHTS, GON5, 6e-4)
    folder, _ = bring(tmp_path / "8", "gsi", [" ".join(w.gsi(SETUPS, SIGHTS))])


@pytest.mark.parametrize("version", ["SDR33", "SDR20"])
@pytest.mark.parametrize("angle", ["deg", "gon", "mil"])
@pytest.mark.parametrize("feet", [False, True])
@pytest.mark.parametrize("order", ["NEZ", "ENZ"])
def test_sdr_in_every_unit(
    tmp_path: Path, version: str, angle: str, feet: bool, *, order: str
) -> None:
    lines = w.sdr(SETUPS, SIGHTS, version=version, angle=angle, feet=feet, order=order)
    folder, result = bring(tmp_path, "sdr", lines)
    coarse = version == "SDR20"
    check_rows(folder, SIGHTS, 1e-4 if coarse else 1e-7, 1e-4 if coarse else 1e-7)
    place = next(s for s in result.stations if s.name == "103")
    assert (place.e, place.n) == pytest.approx((1080.123, 1994.544), abs=1e-4)


def test_sdr_vertical_angles_from_the_horizon(tmp_path: Path) -> None:
    folder, _ = bring(tmp_path, "sdr", w.sdr(SETUPS, SIGHTS, horizon=True))
    check_rows(folder, SIGHTS, 1e-7, 1e-7)


def test_sdr_with_trimmed_lines_and_a_frame(tmp_path: Path) -> None:
    lines = ["\x02", *w.sdr(SETUPS, SIGHTS, trimmed=True), "\x03"]
    folder, _ = bring(tmp_path, "sdr", lines)
    check_rows(folder, SIGHTS, 1e-7, 1e-7)


def test_sdr_columns_are_bytes(tmp_path: Path) -> None:
    lines = w.sdr(SETUPS, SIGHTS)
    header = lines[0].encode()
    cyrillic = header[:20] + "28-Нояб-26".encode("cp1251").ljust(20) + header[40:]
    data = b"\n".join([cyrillic, *(line.encode() for line in lines[1:])]) + b"\n"
    (tmp_path / "p").mkdir()
    (tmp_path / "p" / "project.toml").write_text('format = 1\nname = "t"\n')
    (tmp_path / "f.sdr").write_bytes(data)
    from surveyapp import api

    api.import_file("sdr", tmp_path / "f.sdr", tmp_path / "p", traverse="main")
    check_rows(tmp_path / "p", SIGHTS, 1e-7, 1e-7)


@pytest.mark.parametrize("namespace", ["", "http://example.org/job"])
def test_jobxml_adds_prism_and_ppm_to_the_raw_distance(tmp_path: Path, namespace: str) -> None:
    folder, result = bring(tmp_path, "jobxml", w.jobxml(SETUPS, SIGHTS, namespace=namespace))
    check_rows(folder, SIGHTS, 2e-9, 2e-6)
    text = (folder / "project.toml").read_text(encoding="utf-8")
    assert "atmosphere_applied = true" in text
    assert "constant_applied = true" in text
    raw = rows(folder / "imports" / "main.raw.csv")[0]
    assert float(raw["sd_m"]) != pytest.approx(SIGHTS[0].sd, abs=1e-3)  # as read, not corrected
    assert result.readings == len(SIGHTS)


@pytest.mark.parametrize("angle", ["gon", "deg", "mil"])
@pytest.mark.parametrize(
    ("separator", "comma"), [(",", False), (";", False), (";", True), ("\t", True)]
)
@pytest.mark.parametrize("feet", [False, True])
def test_tables_in_every_unit(
    tmp_path: Path, angle: str, separator: str, comma: bool, *, feet: bool
) -> None:
    lines = w.table(SIGHTS, angle=angle, separator=separator, comma=comma, feet=feet)
    length = "ft" if feet else "m"
    units = {"hz": angle, "v": angle, **dict.fromkeys(("sd", "hi", "ht"), length)}
    folder, _ = bring(tmp_path, "csv", lines, columns=w.TABLE_MAP, units=units)
    check_rows(folder, SIGHTS, 1e-6, 1e-5)


def test_the_two_feet_differ_by_two_ppm(tmp_path: Path) -> None:
    lines = w.gsi(SETUPS, SIGHTS, width=16, length="ft4")
    first, _ = bring(tmp_path / "a", "gsi", lines)
    second, told = bring(tmp_path / "b", "gsi", lines, units={"foot": "us"})
    values = [
        float(rows(folder / "observations" / "main.csv")[2]["value"]) for folder in (first, second)
    ]
    assert values[1] / values[0] - 1.0 == pytest.approx(2e-6, abs=3e-9)
    assert any(x.code == "foot" and "US survey" in x.text for x in told.warnings)
