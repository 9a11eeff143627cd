"""The survey record: what stands in it, that it is the same every time, and that it can be read."""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pypdf
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.simulate.project import project_files, simulate_reversal_project
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.errors import SurveyError
from surveyapp.report import faces
from surveyapp.report.blocks import Figure, Polyline, Table
from surveyapp.report.forms import FORMS
from surveyapp.report.record import SECTIONS, Record, record_document
from surveyapp_models.angles import ARCSEC, AngleUnit, format_angle, parse_angle

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ("johannesburg-1966", "gi-b1-1966", "tongjin-2015")
NAMES = ("Иванов", "Γεωργίου", "潼金矿")


def pdf_text(path: Path) -> str:
    reader = pypdf.PdfReader(path)
    return "\n".join(page.extract_text() for page in reader.pages)


def squeezed(text: str) -> str:
    return re.sub(r"\s+", "", text)


def numbers(value: Any, key: str = "") -> list[tuple[str, float]]:
    """Every number of a JSON document with its key."""
    if isinstance(value, dict):
        return [pair for k, item in value.items() for pair in numbers(item, k)]
    if isinstance(value, list):
        return [pair for item in value for pair in numbers(item, key)]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return []
    return [(key, float(value))]


@pytest.fixture(scope="module")
def named_project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tracked session with strikes, tape zeros, sights, and names in three scripts."""
    folder = tmp_path_factory.mktemp("named")
    (folder / "observations").mkdir()
    (folder / "project.toml").write_text(
        f"""format = 1
name = "{NAMES[2]} <3> & co"
rule_book = "cn-coal-15"
[[instrument]]
id = "G1"
card = "wild-gak1"
scale_value_arcsec = 600.0
period = {{ latitude_deg = 34.5, tracking_s = 430.0, clamped_s = 392.0 }}
[[station]]
name = "甲"
lat = 34.5
lon = 111.2
[[station]]
name = "Б"
[[orientation]]
id = "run-1"
station = "甲"
target = "Б"
instrument = "G1"
method = "tracking"
observer = "{NAMES[0]}, {NAMES[1]}"
book = "observations/run-1.csv"
""",
        encoding="utf-8",
    )
    rows = ["seq,kind,value,unit,face,note"]
    rows += ["1,backsight,040-00-00.0,dms,L,", "2,backsight,220-00-04.0,dms,R,"]
    rows += [f"{3 + k},tape_zero,{0.25 + 2 * (-1) ** k:.2f},div,," for k in range(4)]
    for k in range(7):
        value = format_angle(math.radians(181.0 + 1.2 * (-0.985) ** k), AngleUnit.DMS)
        rows.append(f"{7 + k},reversal,{value},dms,,")
    rows += ["14,strike,9,,,misread", "15,reversal,182-09-51.1,dms,,"]
    rows += ["16,backsight,040-00-01.0,dms,L,", "17,backsight,220-00-05.0,dms,R,"]
    text = "\n".join(rows) + "\n"
    (folder / "observations" / "run-1.csv").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Any]]:
    folder = tmp_path_factory.mktemp("records")
    found = {}
    for name in SAMPLES:
        result = api.report(ROOT / "projects" / name, folder / f"{name}.pdf")
        found[name] = (folder / f"{name}.pdf", result)
    return found


@pytest.mark.parametrize("name", SAMPLES)
def test_the_record_holds_every_number_that_orient_holds(
    name: str, records: dict[str, tuple[Path, Any]]
) -> None:
    """As printed: directions in the project's unit, arc-seconds with two decimals, and in full."""
    text = squeezed(pdf_text(records[name][0]))
    document = json.loads(json.dumps(api.orient(ROOT / "projects" / name).to_dict()))
    found = numbers(document)
    assert len(found) > 20
    for key, value in found:
        whole = repr(int(value)) if value == int(value) and repr(int(value)) in text else None
        assert whole or repr(value) in text, (key, value)
    for group in ("sessions", "lines"):
        for item in document[group]:
            for key, value in item.items():
                if isinstance(value, dict) and "deg" in value:
                    printed = format_angle(math.radians(value["deg"]), AngleUnit.DMS)
                    assert printed in text, (key, printed)
                    assert f"{value['sigma_arcsec']:.2f}" in text


@pytest.mark.parametrize("name", SAMPLES)
def test_the_same_input_gives_the_same_bytes_in_another_process(
    name: str, records: dict[str, tuple[Path, Any]], tmp_path: Path
) -> None:
    path, result = records[name]
    again = tmp_path / "again.pdf"
    command = [sys.executable, "-m", "surveyapp", "report", str(ROOT / "projects" / name)]
    environment = {**os.environ, "PYTHONHASHSEED": "77", "TZ": "Asia/Tokyo"}
    environment["PYTHONPATH"] = os.pathsep.join((str(ROOT), str(ROOT / "models")))
    done = subprocess.run(
        [*command, "-o", str(again), "--json"],
        check=True,
        capture_output=True,
        text=True,
        env=environment,
        cwd=tmp_path,
    )
    assert again.read_bytes() == path.read_bytes()
    printed = json.loads(done.stdout)
    assert printed["sha256"] == result.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert set(printed) == {
        "schema",
        "path",
        "pages",
        "sections",
        "sha256",
        "missing_glyphs",
        "sheets",
        "signature",
        "without_sheet",
        "warnings",
    }
    assert printed["pages"] == result.pages == len(pypdf.PdfReader(path).pages)


@pytest.mark.parametrize("name", SAMPLES)
def test_every_page_has_its_number_the_software_and_the_input(
    name: str, records: dict[str, tuple[Path, Any]]
) -> None:
    path, result = records[name]
    digest = api.open_project(ROOT / "projects" / name).digest
    for index, page in enumerate(pypdf.PdfReader(path).pages, start=1):
        text = page.extract_text()
        assert f"page {index} of {result.pages}" in text
        assert digest in text
        assert api.SOFTWARE in text


def test_a_changed_reading_changes_the_record(tmp_path: Path, named_project: Path) -> None:
    first = api.report(named_project, tmp_path / "a.pdf")
    book = named_project / "observations" / "run-1.csv"
    before = book.read_text(encoding="utf-8")
    try:
        book.write_text(before.replace("182-09-51.1", "182-09-51.2"), encoding="utf-8")
        second = api.report(named_project, tmp_path / "b.pdf")
    finally:
        book.write_text(before, encoding="utf-8")
    assert first.sha256 != second.sha256


@pytest.mark.parametrize("with_face", [True, False])
def test_names_in_three_scripts_can_be_read_back(
    with_face: bool, named_project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a TrueType face where the system has one, and with the CID faces where it has none."""
    if not with_face:
        monkeypatch.setattr("surveyapp.report.pdf.fonts.wide_face", lambda: None)
    elif faces.wide_face() is None:
        pytest.skip("no TrueType face with Chinese on this system")
    api.report(named_project, tmp_path / "names.pdf")
    text = pdf_text(tmp_path / "names.pdf")
    for name in (*NAMES, "<3> & co", "甲-Б"):
        assert name in text
    embedded = (tmp_path / "names.pdf").read_bytes()
    assert b"/FontFile2" in embedded
    assert (b"STSong-Light" in embedded) is not with_face


def test_a_face_that_cannot_be_embedded_is_refused(named_project: Path, tmp_path: Path) -> None:
    wrong = tmp_path / "face.ttf"
    wrong.write_bytes(b"no face at all")
    with pytest.raises(SurveyError) as caught:
        api.report(named_project, tmp_path / "out.pdf", font=wrong)
    assert "cannot be embedded" in caught.value.problems[0].what
    assert not (tmp_path / "out.pdf").exists()


def test_struck_rows_stay_visible_as_struck(named_project: Path) -> None:
    project = api.open_project(named_project)
    document, _ = record_document(Record(project, api.orient(project)))
    (book,) = [b for b in document.blocks if isinstance(b, Table) and "kind" in b.head]
    assert len(book.rows) == len(project.sessions[0].book.rows) == 17
    (index,) = book.struck
    assert book.rows[index][0] == "9"
    assert "struck by row 14: misread" in book.rows[index][-1]
    assert "~9~" in api.report_text(named_project)


def test_corrections_stand_on_their_own_lines_with_their_origin(named_project: Path) -> None:
    text = api.report_text(named_project)
    for words in (
        "= north as observed",
        "tape zero in force",
        "+ tape-zero correction",
        "per division (periods)",
        "= gyro north",
        "sights before",
        "collimation",
        "turning of the tripod",
        "= line reading",
        "= gyro azimuth to Б",
    ):
        assert words in text
    project = api.open_project(named_project)
    (session,) = api.orient(project).sessions
    assert session.tape_zero is not None
    assert session.tape_zero_correction is not None
    coefficient = -((430.0 / 392.0) ** 2 - 1.0) * 600.0  # -lambda mu, physics of the tape
    expected = coefficient * session.tape_zero.value_div
    assert f'{expected:.2f}"' in text


def test_plots_are_vectors_of_every_point(named_project: Path) -> None:
    project = api.open_project(named_project)
    document, _ = record_document(Record(project, api.orient(project)))
    figures = [block for block in document.blocks if isinstance(block, Figure)]
    assert [figure.title.split(":")[0] for figure in figures] == ["Swing", "Residuals; dashed"]
    for figure in figures:
        marks = [item for item in figure.primitives if type(item).__name__ == "Marker"]
        assert len(marks) == 7
        for item in figure.primitives:
            points = item.points if isinstance(item, Polyline) else ()
            assert all(0 <= x <= figure.width_mm and 0 <= y <= figure.height_mm for x, y in points)


def test_verdicts_are_words(records: dict[str, tuple[Path, Any]]) -> None:
    assert "NOT MET" in pdf_text(records["johannesburg-1966"][0])
    text = pdf_text(records["tongjin-2015"][0])
    assert "met" in text
    assert "Limits that the data of this project cannot answer" in text


def test_sections_are_named_in_order(records: dict[str, tuple[Path, Any]]) -> None:
    order = [section.id for section in SECTIONS]
    for _, result in records.values():
        places = [order.index(name) for name in result.sections]
        assert places == sorted(places)
        assert {"head", "fieldbook", "reduction", "checks", "signature"} <= set(result.sections)


@pytest.mark.parametrize("method", FORMS)
def test_a_blank_form_for_every_method(method: str, tmp_path: Path) -> None:
    path = tmp_path / "form.pdf"
    assert main(["report", "--blank", method, "-o", str(path)]) == 0
    text = pdf_text(path)
    assert method in text
    assert "Observed" in text
    kinds = {"tracking": "reversal", "automatic": "azimuth", "transit": "transit"}
    assert kinds.get(method, "scale_reversal") in text


def test_usage_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "--blank", "trackin", "-o", str(tmp_path / "a.pdf")]) == 2
    assert "tracking" in capsys.readouterr().err
    assert main(["report", str(ROOT / "projects" / SAMPLES[0])]) == 2
    assert main(["report", "-o", "x.pdf"]) == 2
    nowhere = tmp_path / "no" / "folder" / "a.pdf"
    assert main(["report", str(ROOT / "projects" / SAMPLES[0]), "-o", str(nowhere)]) == 2


def test_the_writer_is_the_only_one_that_loads_reportlab() -> None:
    code = (
        "import sys; import surveyapp.report.record, surveyapp.report.text, surveyapp.api;"
        "sys.exit('reportlab' in sys.modules)"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "models")))}
    assert (
        subprocess.run([sys.executable, "-c", code], env=environment, check=False).returncode == 0
    )


@pytest.mark.parametrize("method", ["amplitude", "transit"])
def test_a_clamped_swing_shows_its_own_steps(method: str, tmp_path: Path) -> None:
    """The steps add up to gyro north: alidade, middle of the swing, tape zero."""
    spec = SessionSpec(latitude=math.radians(47.0), method=method)  # type: ignore[arg-type]
    simulated = simulate_reversal_project(spec, np.random.default_rng(5))
    for name, text in project_files(simulated).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    project = api.open_project(tmp_path)
    result = api.orient(project)
    document, _ = record_document(Record(project, result))
    tables = [b for b in document.blocks if isinstance(b, Table) and b.head[0] == "step"]
    steps = next({row[0]: row[1] for row in t.rows} for t in tables if t.rows[0][0][:3] == "mid")
    total = parse_angle(steps["clamped alidade"], AngleUnit.DMS)
    for label in ("+ (1 + lambda) mu B", "+ tape-zero correction"):
        total += signed_seconds(steps[label]) * ARCSEC
    north = parse_angle(steps["= gyro north"], AngleUnit.DMS)
    assert abs(total - north) < 0.15 * ARCSEC
    titles = [block.title for block in document.blocks if isinstance(block, Figure)]
    assert any(title.startswith("Swing on the scale") for title in titles)
    api.report(project, tmp_path / "record.pdf")


def signed_seconds(text: str) -> float:
    """Seconds of ``+12.34"`` or of ``-6'40.12"``."""
    sign = -1.0 if text.startswith("-") else 1.0
    minutes, _, rest = text.lstrip("+-").rstrip('"').rpartition("'")
    return sign * (60.0 * float(minutes or 0.0) + float(rest))
