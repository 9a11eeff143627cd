"""Logs of strangers: what is read, and that everything that is wrong is told together."""

import hashlib
import json
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.errors import SurveyError
from surveyapp.io.sensor_cards import read_sensor_card, write_sensor_card
from surveyapp.io.sensor_logs import blocks
from surveyapp.io.sensor_logs.reading import LogRequest, Need, read_log

MAG = ("mag_x_uT", "mag_y_uT", "mag_z_uT")
NEED = Need(columns=MAG, varying=MAG)


def request(path: Path, **options: object) -> LogRequest:
    return LogRequest(path=path, where=path.name, **options)  # type: ignore[arg-type]


def write(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def field_log(path: Path, **changed: object) -> Path:
    rows = [[k * 0.1, 20.0 + k, -3.0 * k, 40.0 - 0.5 * k] for k in range(12)]
    for place, value in changed.items():
        row, column = (int(v) for v in place.removeprefix("r").split("c"))
        rows[row][column] = value  # type: ignore[call-overload]
    lines = ["time_s,mag_x_uT,mag_y_uT,mag_z_uT", *(",".join(map(str, row)) for row in rows)]
    return write(path, "\n".join(lines) + "\n")


def problems_of(request_: LogRequest, need: Need = NEED) -> list[str]:
    with pytest.raises(SurveyError) as caught:
        read_log(request_, need)
    return [f"{p.where}: {p.what}" for p in caught.value.problems]


def test_units_maps_scales_and_titles_before_the_table(tmp_path: Path) -> None:
    text = "Fs,100\nLogger,7\nt,a (g),counts,mx\n0,1,16384,50000\n10,1.5,8192,49000\n20,1,0,1\n"
    path = write(tmp_path / "log.csv", text)
    log = read_log(
        request(
            path,
            columns={
                "time_s": "t",
                "acc_x_m_s2": "a (g)",
                "acc_y_m_s2": "counts",
                "mag_x_uT": "mx",
            },
            units={"t": "ms", "counts": "g", "mx": "nT"},
            scale={"counts": 1 / 16384},
        ),
        Need(columns=("acc_x_m_s2", "acc_y_m_s2", "mag_x_uT")),
    )
    assert log.columns["time_s"] == pytest.approx([0.0, 0.01, 0.02])
    assert log.columns["acc_x_m_s2"][1] == pytest.approx(1.5 * 9.80665)
    assert log.columns["acc_y_m_s2"] == pytest.approx([9.80665, 4.903325, 0.0])
    assert log.columns["mag_x_uT"][0] == pytest.approx(50.0)
    assert log.rate_hz == pytest.approx(100.0)
    assert log.scaled == {"acc_y_m_s2": pytest.approx(9.80665 / 16384)}
    assert log.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_table_without_names_and_one_with_semicolons(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", "0,1,2\n1,2,3\n2,4,4\n")
    log = read_log(request(path, columns={"mag_x_uT": "2"}), Need(("mag_x_uT",), timed="no"))
    assert log.columns["mag_x_uT"].tolist() == [1.0, 2.0, 4.0]
    path = write(tmp_path / "b.csv", "time_s;mag_x_uT\n0;1.5\n1;2.5\n")
    log = read_log(request(path), Need(("mag_x_uT",)))
    assert log.columns["mag_x_uT"].tolist() == [1.5, 2.5]


def test_everything_that_is_wrong_is_told_together(tmp_path: Path) -> None:
    path = field_log(
        tmp_path / "log.csv",
        r3c1="nan",
        r4c2="",
        r5c0=0.4,
        r7c0=0.1,
        **{f"r{k}c3": 40.0 for k in range(12)},
    )
    told = problems_of(request(path))
    assert "log.csv, line 5: mag_x_uT is not a number in 1 row" in told
    assert "log.csv, line 6: mag_y_uT is not a number in 1 row" in told
    assert "log.csv: mag_z_uT is constant" in told
    assert any("time_s stands twice in 1 place" in text for text in told)
    assert any("time_s runs backwards" in text for text in told)


def test_text_and_torn_rows_are_named_by_line(tmp_path: Path) -> None:
    path = field_log(tmp_path / "log.csv", r2c1="12,5", r6c3="n/a")
    told = problems_of(request(path))
    assert "log.csv, line 4: a row of another width" in told
    assert "log.csv, line 8: mag_z_uT is no number" in told
    path.write_text(path.read_text()[:-8])
    assert any(text.startswith("log.csv, line 13") for text in problems_of(request(path)))


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "the log is empty"),
        ("\n\n", "the log is empty"),
        ("time_s,mag_x_uT,mag_y_uT,mag_z_uT\n", "the log has no row"),
        ("time_s,mag_x_uT\n0,1\n1,2\n", "the column mag_y_uT is missing"),
        ("mag_x_uT,mag_y_uT,mag_z_uT\n1,2,3\n2,3,4\n", "the column time_s is missing"),
        ("a\x00b\n", "this is a binary file"),
    ],
)
def test_files_that_are_no_log(tmp_path: Path, text: str, what: str) -> None:
    path = write(tmp_path / "log.csv", text)
    assert any(what in told for told in problems_of(request(path)))


def test_counts_other_units_and_unknown_ones(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(50, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    head = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyr_x_rad_s\n"
    acc = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")

    def log(factor: float) -> Path:
        values = np.round(directions * factor) if factor > 100.0 else directions * factor
        rows = [f"{k},{v[0]:g},{v[1]:g},{v[2]:g},{k - 25}" for k, v in enumerate(values)]
        return write(tmp_path / "log.csv", head + "\n".join(rows))

    need = Need(columns=(*acc, "gyr_x_rad_s"))
    told = problems_of(request(log(16384.0)), need)
    assert "log.csv: acc_x/y/z are counts without a unit" in told
    assert "log.csv: gyr_x_rad_s is counts without a unit" in told
    with pytest.raises(SurveyError, match="is it g"):
        read_log(request(log(1.0)), Need(columns=acc))
    told = problems_of(request(log(9.8), units={"gyr_x_rad_s": "LSB"}), need)
    assert told == ["log.csv, gyr_x_rad_s: gyr_x_rad_s is counts without a scale"]
    told = problems_of(request(log(9.8), units={"acc_x_m_s2": "uT", "nobody": "g"}), need)
    assert "log.csv, acc_x_m_s2: this unit does not fit the column" in told
    assert "log.csv, `units`: the file has no such column" in told
    told = problems_of(request(log(9.8), columns={"acc_q": "x", "mag_x_uT": "mx"}), need)
    assert "log.csv, `columns`: there is no such column" in told
    assert "log.csv, `columns` mag_x_uT: the file has no such column" in told


def test_one_axis_in_another_unit_is_found(tmp_path: Path) -> None:
    text = "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n"
    text += "".join(
        f"{k},{30 * np.cos(k):.3f},{30 * np.sin(k):.3f},{40e3 + 2e4 * np.sin(2 * k):.1f}\n"
        for k in range(40)
    )
    told = problems_of(request(write(tmp_path / "log.csv", text)))
    assert "log.csv: mag_x/y/z are in different units" in told


def test_gaps_and_clipped_values_are_warnings_and_round_values_are_not(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    time = np.arange(400) * 0.01
    time[200:] += 3.0
    values = rng.normal(size=400)
    rows = [f"{t:.3f},{min(v, 0.9):.6f},{v:.1f}" for t, v in zip(time, values, strict=True)]
    path = write(tmp_path / "log.csv", "time_s,gyr_x_rad_s,gyr_y_rad_s\n" + "\n".join(rows))
    log = read_log(request(path), Need(columns=("gyr_x_rad_s", "gyr_y_rad_s")))
    assert [(g.start_s, g.end_s) for g in log.gaps] == [(1.99, 5.0)]
    assert list(log.clipped) == ["gyr_x_rad_s"]
    assert log.clipped["gyr_x_rad_s"] == int(np.sum(np.round(values, 6) >= 0.9))
    assert [w.code for w in log.warnings] == ["gaps", "clipped"]


def test_blocks_of_any_size_give_the_same_columns(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(3)
    values = rng.normal(size=(3000, 2)) + 30.0
    rows = [f"{k * 0.02:.2f},{a!r},{b!r}" for k, (a, b) in enumerate(values.tolist())]
    path = write(tmp_path / "log.csv", "time_s,mag_x_uT,mag_y_uT\n" + "\r\n".join(rows))
    need = Need(columns=("mag_x_uT", "mag_y_uT"))
    whole = read_log(request(path), need)
    monkeypatch.setattr(blocks, "BLOCK_BYTES", 1000)
    monkeypatch.setattr(blocks, "MAPPED_VALUES", 100)
    shares: list[float] = []
    pieces = read_log(request(path), need, progress=shares.append)
    assert isinstance(pieces.columns["mag_x_uT"].base, np.memmap)
    for name, column in whole.columns.items():
        assert np.array_equal(column, pieces.columns[name])
    assert np.array_equal(whole.columns["mag_x_uT"], values[:, 0])
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def project(folder: Path, table: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "project.toml").write_text('format = 1\nname = "x"\n' + table)
    return folder


def test_sensor_log_tables_are_a_field_of_the_project(tmp_path: Path) -> None:
    field_log(tmp_path / "log.csv")
    table = (
        '[[sensor_log]]\nid = "swing"\nkind = "compass"\nfile = "log.csv"\nrate_hz = 10\n'
        'columns = { time_s = "t" }\nunits = { mx = "nT" }\nscale = { mx = 0.5 }\n'
        "calibrated_on = 2026-03-01\nlatitude_deg = 35.2\n"
    )
    entry = api.open_project(project(tmp_path, table)).sensor_logs[0]
    assert (entry.id, entry.kind, entry.rate_hz) == ("swing", "compass", 10.0)
    assert entry.columns == {"time_s": "t"}
    assert (entry.units, entry.scale) == ({"mx": "nT"}, {"mx": 0.5})
    assert (entry.calibrated_on, entry.latitude_deg) == (date(2026, 3, 1), 35.2)


def test_wrong_sensor_log_tables_are_told_together(tmp_path: Path) -> None:
    table = (
        '[[sensor_log]]\nid = "a"\nkind = "compas"\nfile = "a.csv"\nunits = { x = "tesla" }\n'
        '[[sensor_log]]\nid = "a"\nfile = "b.csv"\nscale = { x = 0 }\ncolumns = { time = "t" }\n'
    )
    with pytest.raises(SurveyError) as caught:
        api.open_project(project(tmp_path, table))
    told = "\n".join(str(p) for p in caught.value.problems)
    for part in ("kind is not known", "no known unit", "one id", "no usable scale", "no such col"):
        assert part in told


def tilt_log(path: Path) -> Path:
    rng = np.random.default_rng(5)
    n = 84
    own, other = rng.uniform(-600, 600, (2, n))
    theta = rng.uniform(5, 35, n)
    along = 12.0 + 1.003 * own + 0.02 * other + 0.8 * (theta - 20.0) + rng.normal(0, 1.0, n)
    across = -5.0 + 0.996 * other - 0.01 * own - 0.3 * (theta - 20.0) + rng.normal(0, 1.0, n)
    rows = [
        ",".join(f"{v:.3f}" for v in row)
        for row in zip(np.arange(n), along, across, own, other, theta, strict=True)
    ]
    head = "time_s,tilt_along_arcsec,tilt_across_arcsec,ref_along_arcsec,ref_across_arcsec"
    return write(path, head + ",temperature_c\n" + "\n".join(rows) + "\n")


def test_a_log_outside_the_project_needs_leave_and_a_pinned_one_its_sha256(tmp_path: Path) -> None:
    path = tilt_log(tmp_path / "log.csv")
    folder = tmp_path / "p"
    table = '[[sensor_log]]\nid = "t"\nkind = "tilt"\nfile = "../log.csv"\n'
    project(folder, table)
    with pytest.raises(SurveyError, match="outside of the project folder"):
        api.calibrate("tilt", folder, sensor="t")
    allowed = api.calibrate("tilt", folder, sensor="t", allow_outside=True)
    assert allowed.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    project(folder, table + f'sha256 = "{"0" * 64}"\n')
    with pytest.raises(SurveyError, match="not the one that was pinned"):
        api.calibrate("tilt", folder, allow_outside=True)
    project(folder, table.replace('"tilt"', '"rate"'))
    with pytest.raises(SurveyError, match="of another kind"):
        api.calibrate("tilt", folder, allow_outside=True)


def test_two_axes_on_the_command_line_and_on_a_card(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, card = tilt_log(tmp_path / "log.csv"), tmp_path / "card.toml"
    assert main(["calibrate", "tilt", str(path), "--json", "--card", str(card)]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["schema"] == "surveyapp.calibrate/1"
    truth = {
        "zero_along": 12.0, "scale_along": 1.003, "cross_along": 0.02, "temperature_along": 0.8,
        "zero_across": -5.0, "scale_across": 0.996, "cross_across": -0.01,
        "temperature_across": -0.3,
    }  # fmt: skip
    assert {p["name"] for p in result["parameters"]} == set(truth)
    for item in result["parameters"]:
        assert abs(item["value"] - truth[item["name"]]) < 4.0 * item["sigma"], item
    assert 3.0 < result["held_out"]["before"] < 12.0
    assert 0.8 < result["held_out"]["after"] < 1.3
    read = read_sensor_card(card)
    assert read.kind == "tilt"
    assert read.sha256 == result["sha256"]
    assert read.get("scale_along") == result["parameters"][2]["value"]
    assert read.covariance is not None
    assert read.covariance.shape == (8, 8)
    assert read.temperature_c is not None
    assert main(["calibrate", "tilt", str(path)]) == 0
    assert "cross_along" in capsys.readouterr().out


def test_exchanged_axes_and_bad_options_end_with_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(tilt_log(tmp_path / "log.csv"))
    swapped = ["--map", "tilt_along_arcsec=tilt_across_arcsec",
               "tilt_across_arcsec=tilt_along_arcsec"]  # fmt: skip
    assert main(["calibrate", "tilt", path, *swapped]) == 2
    assert "exchanged" in capsys.readouterr().err
    assert main(["calibrate", "tilt", path, "--map", "time_s", "--scale", "x=y", "--json"]) == 2
    told = json.loads(capsys.readouterr().out)
    assert told["schema"] == "surveyapp.error/1"
    assert [p["where"] for p in told["problems"]] == ["--map", "--scale x"]
    assert main(["calibrate", "tilts", path]) == 2
    assert "tilt" in capsys.readouterr().err


def test_a_card_holds_within_its_days_and_temperatures(tmp_path: Path) -> None:
    card = SensorCard(
        id="c", title="Card", kind="tilt", source="here",
        parameters=(SensorParameter("scale_along", 1.0, 0.001, "1"),),
        valid_from=date(2026, 1, 1), valid_to=date(2026, 12, 31), temperature_c=(5.0, 30.0),
        constants={"reference_temperature_c": 20.0}, notes={"range": "near level"},
    )  # fmt: skip
    path = tmp_path / "card.toml"
    write_sensor_card(path, card)
    assert read_sensor_card(path) == card
    assert card.refusals(on=date(2026, 6, 1), temperature_c=(10.0, 20.0), where="c") == []
    told = card.refusals(on=date(2027, 1, 1), temperature_c=(4.0, 31.0), where="c")
    assert [p.found for p in told] == ["2027-01-01", "4 to 31 C"]
    other = tmp_path / "other.toml"
    other.write_text("x = 1\n")
    with pytest.raises(SurveyError, match="no sensor card"):
        write_sensor_card(other, card)
    path.write_text('id = "c"\nkind = "tilt"\n[parameter.a]\nvalue = "x"\n')
    with pytest.raises(SurveyError) as caught:
        read_sensor_card(path)
    assert len(caught.value.problems) >= 4


def test_the_rate_of_times_that_a_logger_rounded(tmp_path: Path) -> None:
    """286 Hz in whole milliseconds has steps of 3 and 4: the median would be 333 Hz."""

    def rate(times: list[float]) -> float | None:
        rows = "\n".join(f"{t:.3f},{k % 7},{k % 5}.5,{k % 3}.5" for k, t in enumerate(times))
        path = write(tmp_path / "log.csv", f"time_s,mag_x_uT,mag_y_uT,mag_z_uT\n{rows}\n")
        return read_log(request(path), NEED).rate_hz

    assert rate([round(k / 286.0, 3) for k in range(2861)]) == pytest.approx(286.0, rel=1e-4)
    assert rate([round(k / 80.0, 2) for k in range(801)]) == pytest.approx(80.0, rel=1e-3)
    missing = [k / 100.0 for k in range(1000) if k % 23]
    assert rate(missing) == pytest.approx(100.0, rel=1e-9)
    with_gap = [k / 100.0 + (500.0 if k > 400 else 0.0) for k in range(1000)]
    assert rate(with_gap) == pytest.approx(100.0, rel=1e-6)


def test_a_column_without_a_name_keeps_its_first_number(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "".join(f"{v}\n" for v in (5.0, 1.5, 2.5, 4.0)))
    log = read_log(request(path, rate_hz=1.0), Need(others=("1",)))
    assert log.columns["1"].tolist() == [5.0, 1.5, 2.5, 4.0]
    named = write(tmp_path / "named.csv", "100\nfreq\n1.5\n2.5\n")
    assert read_log(request(named, rate_hz=1.0, header_rows=1), Need(others=("freq",))).size == 2


def test_counts_under_the_name_of_a_field_and_a_clock_under_that_of_seconds(tmp_path: Path) -> None:
    rows = "\n".join(f"{k},{600 - 100 * k},{50 * k},{-70 * k}" for k in range(12))
    path = write(tmp_path / "log.csv", f"time_s,mag_x_uT,mag_y_uT,mag_z_uT\n{rows}\n")
    assert "log.csv: mag_x_uT is counts without a unit" in problems_of(request(path))
    log = read_log(request(path, scale={"mag_x_uT": 0.1, "mag_y_uT": 0.1, "mag_z_uT": 0.1}), NEED)
    assert log.columns["mag_x_uT"][0] == pytest.approx(60.0)
    rows = "\n".join(f"2026-01-01T00:00:{k:02d},{k}.5,{k},1.{k}" for k in range(12))
    write(path, f"time_s,mag_x_uT,mag_y_uT,mag_z_uT\n{rows}\n")
    with pytest.raises(SurveyError) as caught:
        read_log(request(path), NEED)
    assert "seconds" in caught.value.problems[0].hint
