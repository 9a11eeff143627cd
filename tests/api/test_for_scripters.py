"""What scripts may build on: frozen results with a JSON, flat records, types that can be named."""

from __future__ import annotations

import csv
import dataclasses
import inspect
import io
import json
import typing
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.domain.records import flat

SAMPLE = Path(__file__).resolve().parents[2] / "projects" / "tongjin-2015"
FUNCTIONS = [name for name in api.__all__ if inspect.isfunction(getattr(api, name))]
PLAIN = {
    "generator_of": "a random generator of numpy",
    "cluster_executor": "an executor in a with statement",
    "has_breakthrough": "yes or no",
    "has_shafts": "yes or no",
    "report_text": "text for a terminal",
    "undrawn_text": "text for a terminal",
    "record_step": "it writes one step of a procedure",
    "batch_rows": "rows one by one, of a known type",
}


def returned(name: str) -> object:
    """The type that a function returns."""
    function = getattr(api, name)
    space = {**vars(inspect.getmodule(function)), **{n: getattr(api, n) for n in api.__all__}}
    return eval(inspect.signature(function).return_annotation, space)


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if name not in PLAIN])
def test_a_function_returns_a_frozen_result_with_a_json_that_can_be_named(name: str) -> None:
    kind = returned(name)
    kinds = [typing.get_origin(kind) or kind, *typing.get_args(kind)]
    for item in kinds:
        assert isinstance(item, type)
        assert dataclasses.is_dataclass(item), item
        assert vars(item)["__dataclass_params__"].frozen, item
        assert callable(getattr(item, "to_dict", None)), item
        assert getattr(api, item.__name__) is item, "it stands in surveyapp.api"
        assert item.__name__ in api.__all__


def test_every_name_of_all_exists() -> None:
    assert len(set(api.__all__)) == len(api.__all__)
    for name in api.__all__:
        assert getattr(api, name) is not None
    with pytest.raises(AttributeError, match="has no nonsense"):
        _ = api.nonsense


def test_rows_are_what_csv_takes() -> None:
    result = api.orient(SAMPLE)
    for table in ("lines", "sessions", "constants", "checks", "warnings"):
        rows = result.rows(table)
        assert len(rows) == len(result.to_dict()[table])
        columns = list(dict.fromkeys(key for row in rows for key in row))
        stream = io.StringIO()
        writer = csv.DictWriter(stream, columns)
        writer.writeheader()
        writer.writerows(rows)
        assert len(stream.getvalue().splitlines()) >= len(rows)
    (first, *_) = result.rows()
    assert first["grid_azimuth.deg"] == result.lines[0].to_dict()["grid_azimuth"]["deg"]
    assert [row["rule"] for row in api.check(SAMPLE).rows()] == [c.rule for c in result.checks]


def test_flat_joins_names_and_leaves_out_tables() -> None:
    item = {"a": {"b": {"c": 1.0}}, "s": ["x", None, 2], "rows": [{"k": 1}], "n": None}
    assert flat(item) == {"a.b.c": 1.0, "s": "x  2", "n": None}


def test_angles_stand_in_degrees_and_seconds_beside_their_sigma() -> None:
    line = api.orient(SAMPLE).lines[0]
    azimuth = line.grid_azimuth
    assert azimuth is not None
    data = line.to_dict()
    assert azimuth.deg == data["grid_azimuth"]["deg"]
    assert azimuth.arcsec == pytest.approx(azimuth.deg * 3600.0)
    assert azimuth.sigma_arcsec == data["grid_azimuth"]["sigma_arcsec"]
    assert azimuth.interval95_arcsec == data["grid_azimuth"]["interval95_arcsec"]
    assert line.constant_arcsec == data["constant"]["arcsec"]
    assert line.constant_sigma_arcsec == data["constant"]["sigma_arcsec"]
    assert line.convergence_arcsec == data["convergence_arcsec"]
    constant = api.orient(SAMPLE).constants[0]
    assert constant.arcsec == constant.to_dict()["arcsec"]
    assert constant.arcsec is not None
    assert constant.deg == pytest.approx(constant.arcsec / 3600.0)


def test_listings_have_the_json_of_their_command(tmp_path: Path) -> None:
    for made in (api.models(), api.subjects(SAMPLE), api.unfinished(SAMPLE), api.plan(SAMPLE)):
        document = made.to_dict()
        assert document["schema"].startswith("surveyapp.")
        json.dumps(document, allow_nan=False)
        assert len(made.rows()) == len(made)
    folder = api.new_project(tmp_path / "new")
    assert folder.to_dict() == {
        "schema": "surveyapp.new/1",
        "path": str(tmp_path / "new"),
        "to_enter": [],
    }
    assert api.open_project(folder).to_dict()["name"] == "new"
    json.dumps(api.open_project(SAMPLE).to_dict(), allow_nan=False)


UNITS = (("gyr", "rad_s"), ("acc", "m_s2"))


def test_errors_of_arguments_name_the_argument() -> None:
    with pytest.raises(api.SurveyError) as caught:
        api.orient(SAMPLE, session="nowhere")
    assert caught.value.problems[0].where == "session"
    with pytest.raises(api.SurveyError) as caught:
        api.orient(SAMPLE, line="A-B")
    assert caught.value.problems[0].where == "line"
    with pytest.raises(api.SurveyError) as caught:
        api.plan(SAMPLE, station="nowhere")
    assert caught.value.problems[0].where == "station"
    assert not any("--" in str(problem) for problem in caught.value.problems)


def test_errors_of_north_name_the_argument(tmp_path: Path) -> None:
    names = [f"{sensor}_{a}_{unit}" for sensor, unit in UNITS for a in "xyz"]
    rows = [",".join((f"{k / 10}", *["0.01"] * 5, "9.8", "run")) for k in range(50)]
    path = tmp_path / "log.csv"
    path.write_text("\n".join((",".join(("time_s", *names, "phase")), *rows)), encoding="utf-8")
    with pytest.raises(api.SurveyError) as caught:
        api.north(path, method="rotation", options={"latitude": "x"})
    told = {problem.where for problem in caught.value.problems}
    assert {"latitude", "initial_heading_deg", "initial_reference"} <= told
    assert not any("--" in place for place in told)
