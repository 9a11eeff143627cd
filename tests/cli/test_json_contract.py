"""The JSON of ``orient`` and ``check``: every key always there, the right types, never NaN."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp.core.simulate.kinds import simulate_kind
from surveyapp.core.simulate.project import project_files, simulate_reversal_project
from surveyapp.core.simulate.specification import SessionSpec
from tests.cli.command import GOOD_TOML, good_project, run

PROJECTS = Path(__file__).parents[2] / "projects"
SAMPLES = {"gi-b1-1966": 0, "johannesburg-1966": 1, "tongjin-2015": 1}

Shape = Mapping[str, Any]
"""Key to a type, a tuple of types, a nested shape, or a list of one of these; (x, None) is null."""

TEXT, FLAG, COUNT = str, bool, int
NUMBER = (float, int)
MAYBE = (float, int, None)
ANGLE: Shape = {"deg": NUMBER, "sigma_arcsec": MAYBE}
AZIMUTH: Shape = {**ANGLE, "interval95_arcsec": MAYBE}
CONSTANT: Shape = {"arcsec": NUMBER, "sigma_arcsec": MAYBE, "choice": TEXT}
CHECK: Shape = {
    "rule": TEXT,
    "clause": TEXT,
    "value": MAYBE,
    "limit": MAYBE,
    "confirmed": FLAG,
    "pass": (bool, None),
}
WARNING: Shape = {"code": TEXT, "text": TEXT}
SESSION: Shape = {
    "id": TEXT,
    "method": TEXT,
    "estimator": TEXT,
    "gyro_north": (ANGLE, None),
    "line_reading": (ANGLE, None),
    "gyro_azimuth": (ANGLE, None),
    "points_used": COUNT,
    "dof": COUNT,
    "sigma_source": (str, None),
    "interval95_arcsec": MAYBE,
    "residual_rms_arcsec": MAYBE,
    "amplitude_arcsec": MAYBE,
    "damping_per_half_swing": MAYBE,
    "period_s": MAYBE,
    "tape_zero_correction_arcsec": MAYBE,
}
BY_LINE: Shape = {
    "station": TEXT,
    "target": TEXT,
    "arcsec": NUMBER,
    "sigma_arcsec": MAYBE,
    "n": COUNT,
    "rounds": COUNT,
    "distance_m": MAYBE,
}
INSTRUMENT: Shape = {
    "instrument": TEXT,
    "arcsec": MAYBE,
    "sigma_arcsec": MAYBE,
    "n": COUNT,
    "stable": (bool, None),
    "choice": (str, None),
    "by_line": [BY_LINE],
}
LINE: Shape = {
    "station": TEXT,
    "target": TEXT,
    "rounds": COUNT,
    "sessions": [TEXT],
    "constant": (CONSTANT, None),
    "true_azimuth": ({**AZIMUTH, "reference": TEXT}, None),
    "deflection_arcsec": MAYBE,
    "convergence_arcsec": MAYBE,
    "arc_to_chord_arcsec": MAYBE,
    "grid_azimuth": (AZIMUTH, None),
    "direction_from_south": MAYBE,
    "budget": [{"source": TEXT, "sigma_arcsec": NUMBER}],
}
ORIENT: Shape = {
    "schema": TEXT,
    "sessions": [SESSION],
    "constants": [INSTRUMENT],
    "lines": [LINE],
    "checks": [CHECK],
    "warnings": [WARNING],
}


def conform(value: object, shape: object, at: str) -> None:
    """Assert that a JSON value has the shape."""
    if isinstance(shape, tuple):
        plain = tuple(kind for kind in shape if isinstance(kind, type))
        nested = [kind for kind in shape if isinstance(kind, Mapping)]
        if value is None:
            assert None in shape, f"{at} is null"
        elif isinstance(value, Mapping) and nested:
            conform(value, nested[0], at)
        else:
            assert type(value) in plain, f"{at}: {value!r}"
    elif isinstance(shape, Mapping):
        assert isinstance(value, Mapping), at
        assert set(shape) <= set(value), f"{at} lacks {set(shape) - set(value)}"
        for key, inner in shape.items():
            conform(value[key], inner, f"{at}.{key}")
    elif isinstance(shape, list):
        assert isinstance(value, Sequence), at
        for i, item in enumerate(value):
            conform(item, shape[0], f"{at}[{i}]")
    else:
        assert type(value) is shape, f"{at}: {value!r}"


def walk(value: object, at: str = "") -> None:
    """Assert what holds for every number by the name of its key."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            walk(inner, f"{at}.{key}")
            if inner is None:
                continue
            if key in ("deg", "existing_azimuth_deg", "direction_from_south"):
                assert 0.0 <= inner < 360.0, f"{at}.{key} = {inner}"
            if "sigma" in key and isinstance(inner, float):
                assert inner >= 0.0, f"{at}.{key} = {inner}"
    elif isinstance(value, list):
        for i, item in enumerate(value):
            walk(item, f"{at}[{i}]")


def keeps_the_contract(folder: Path) -> int:
    answer = run("orient", folder, "--json")
    assert answer.code in (0, 1), answer
    document = answer.json
    assert document["schema"] == "surveyapp.orient/1"
    conform(document, ORIENT, "orient")
    walk(document)
    failed = [row for row in document["checks"] if row["confirmed"] and row["pass"] is False]
    assert answer.code == int(bool(failed))
    for line in document["lines"]:
        if line["budget"]:
            final = line["grid_azimuth"] or line["true_azimuth"] or line["gyro_azimuth"]
            total = sum(row["sigma_arcsec"] ** 2 for row in line["budget"])
            assert total == pytest.approx(final["sigma_arcsec"] ** 2, rel=1e-6)
    checked = run("check", folder, "--json")
    assert checked.code == answer.code
    assert checked.json["schema"] == "surveyapp.check/1"
    assert checked.json["warnings"] == document["warnings"]
    assert checked.json["checks"] == document["checks"]
    text = run("orient", folder)
    assert text.code == answer.code
    assert max(len(line) for line in text.out.splitlines()) <= 80, text.out
    assert max(len(line) for line in run("check", folder).out.splitlines()) <= 80
    return answer.code


def put(folder: Path, files: Mapping[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder


@pytest.mark.parametrize("sample", SAMPLES)
def test_samples_keep_the_contract(sample: str) -> None:
    assert keeps_the_contract(PROJECTS / sample) == SAMPLES[sample]


@pytest.mark.parametrize("method", ["tracking", "amplitude", "transit"])
def test_simulated_projects_keep_the_contract(tmp_path: Path, method: Any) -> None:
    spec = SessionSpec(method=method, points=8)
    made = simulate_reversal_project(spec, np.random.default_rng(5))
    keeps_the_contract(put(tmp_path, project_files(made)))


def test_a_simulated_campaign_keeps_the_contract(tmp_path: Path) -> None:
    files, _ = simulate_kind("campaign", effects=["temperature=1.5"], seed=5)
    keeps_the_contract(put(tmp_path, files))


@pytest.mark.parametrize("effect", ["dry_friction=20", "midpoint_step=25,at=0.5"])
def test_disturbed_runs_keep_the_contract(tmp_path: Path, effect: str) -> None:
    files, _ = simulate_kind("reversal-run", effects=[effect], seed=5)
    keeps_the_contract(put(tmp_path, files))


@pytest.mark.parametrize(
    "without",
    [
        'crs = "EPSG:4546"\n',
        "constant = { arcsec = -9.7, sigma_arcsec = 3.0 }\n",
        'target = "B"\n',
        "e = 431630.663\nn = 3811452.311\n",
        "e = 431634.860\nn = 3811581.143\n",
    ],
)
def test_what_is_not_known_is_null_and_not_missing(tmp_path: Path, without: str) -> None:
    assert without in GOOD_TOML
    keeps_the_contract(good_project(tmp_path, toml=GOOD_TOML.replace(without, "")))


def test_a_project_without_sessions_keeps_the_contract(tmp_path: Path) -> None:
    head = GOOD_TOML.partition("[[orientation]]")[0]
    document = run("orient", good_project(tmp_path, toml=head), "--json").json
    conform(document, ORIENT, "orient")
    assert document["sessions"] == []


UNITS = {
    "dms": ("40-00-00", "220-00-04", ["359-00-00", "1-00-00", "359-00-36", "0-59-24"]),
    "gon": ("44.4444", "244.4457", ["398.8889", "1.1111", "398.9000", "1.1000"]),
    "deg": ("40.0000", "220.0011", ["359.0000", "1.0000", "359.0100", "0.9900"]),
}


@pytest.mark.parametrize("unit", UNITS)
def test_tables_speak_the_unit_of_the_project(tmp_path: Path, unit: str) -> None:
    left, right, points = UNITS[unit]
    toml = GOOD_TOML.replace('"dms"', f'"{unit}"')
    rows = [f"backsight,{left},L,B", f"backsight,{right},R,B"]
    rows += [f"reversal,{point},," for point in points]
    book = "seq,kind,value,face,target\n"
    book += "".join(f"{i},{row}\n" for i, row in enumerate(rows, 1))
    folder = good_project(tmp_path, toml=toml, book=book)
    keeps_the_contract(folder)
    document = run("orient", folder, "--json").json
    line = document["lines"][0]
    budget = {row["source"]: row["sigma_arcsec"] for row in line["budget"]}
    assert budget["sights"] < 10.0  # read to 1", 0.1 mgon, 0.36": never to whole degrees
    # the sight is 40 degrees from a north close to the circle's zero, the constant -9.7"
    assert document["sessions"][0]["gyro_azimuth"]["deg"] == pytest.approx(40.0, abs=0.003)
    true = line["true_azimuth"]["deg"] - line["gyro_azimuth"]["deg"]
    assert true * 3600.0 == pytest.approx(-9.7, abs=1e-6)
    text = run("orient", folder).out
    written = {"dms": "39-59-", "gon": "44.44", "deg": "39.99"}[unit]
    row = next(row for row in text.splitlines() if row.strip().startswith("gyro azimuth"))
    assert written in row, text


def test_one_session_alone_keeps_the_contract() -> None:
    folder = PROJECTS / "tongjin-2015"
    answer = run("orient", folder, "--session", "3083-3082", "--json")
    conform(answer.json, ORIENT, "orient")
    assert [session["id"] for session in answer.json["sessions"]] == ["3083-3082"]
    assert [line["target"] for line in answer.json["lines"]] == ["3082"]


def test_the_conformer_can_fail() -> None:
    good = run("orient", PROJECTS / "gi-b1-1966", "--json").json
    for key, wrong in (("sigma_source", 3), ("dof", None), ("points_used", 6.0)):
        bad = {**good, "sessions": [{**good["sessions"][0], key: wrong}]}
        with pytest.raises(AssertionError):
            conform(bad, ORIENT, "orient")
    lacking = {**good, "sessions": [{"id": "round-3"}]}
    with pytest.raises(AssertionError, match="lacks"):
        conform(lacking, ORIENT, "orient")
