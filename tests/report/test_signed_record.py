"""The signature reaches the record; letters that no face has are told and never look alike."""

from __future__ import annotations

import io
from datetime import UTC, datetime
from pathlib import Path

import pytest
from pypdf import PdfReader

from surveyapp import api
from surveyapp.api.office import undrawn_text
from surveyapp.cli.main import main
from surveyapp.observation.record import record_outdated, write_record
from surveyapp.report.blocks import Document, Paragraph
from surveyapp.report.pdf import fonts, write_pdf
from tests.tui.helpers_tui import make_calibrations

STATIONS = ("\u0645\u062d\u0637\u0629\u0661", "\u0646\u0642\u0637\u0629\u0662")


@pytest.fixture
def _base_face_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without further faces."""
    monkeypatch.setattr(fonts, "further_faces", lambda: iter(()))
    monkeypatch.setattr(fonts, "wide_face", lambda: None)


def now() -> datetime:
    return datetime(2026, 11, 28, 16, 0, tzinfo=UTC)


def text_of(data: bytes) -> str:
    return "".join(page.extract_text() for page in PdfReader(io.BytesIO(data)).pages)


def test_a_signed_session_stands_on_the_first_page(tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    output = tmp_path / "record.pdf"
    api.report(folder, output)
    assert "not signed as a whole" in text_of(output.read_bytes())
    closed = api.close(folder, session="k1", by="M. Weber", now=now)
    api.report(folder, output)
    first = PdfReader(str(output)).pages[0].extract_text()
    for word in ("verdict", "M. Weber", "2026-11-28T16:00:00", closed.head):
        assert word in first, word
    assert api.check(folder, seal=closed.head)[-1].passed


@pytest.mark.usefixtures("_base_face_alone")
def test_letters_that_no_face_has_are_told_and_look_different(tmp_path: Path) -> None:
    document = Document("t", "", (), tuple(Paragraph(name) for name in STATIONS))
    written = write_pdf(document)
    assert {text for text, _ in written.missing} >= set(STATIONS)
    text = text_of(written.data)
    # drawn from right to left: TEH MARBUTA before TAH, HAH, MEEM
    assert "[0629][0637][062D][0645]" in text or "[0645][062D][0637][0629]" in text
    assert text.count("[0646]") == 1


@pytest.mark.usefixtures("_base_face_alone")
def test_the_report_tells_what_it_cannot_print(tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    path = folder / "project.toml"
    path.write_text(path.read_text("utf-8").replace("3090", STATIONS[0]), encoding="utf-8")
    assert STATIONS[0] in undrawn_text(api.open_project(folder))
    made = api.report(folder, tmp_path / "record.pdf").to_dict()
    assert [item["code"] for item in made["warnings"]] == ["glyphs_missing"]
    told = {item["text"]: item["characters"] for item in made["missing_glyphs"]}
    assert "U+0645" in told[STATIONS[0]]


def test_a_record_on_the_disk_is_called_out_of_date_wherever_it_is_met(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = make_calibrations(tmp_path / "p")
    assert not record_outdated(api.open_project(folder))  # there is none
    write_record(folder)
    assert not record_outdated(api.open_project(folder))
    book = folder / "observations" / "k1.csv"
    whole = book.read_text("utf-8")
    book.write_text(whole + "9,,,note,,,,,,,wet\n", "utf-8")
    assert record_outdated(api.open_project(folder))
    book.write_text(whole, "utf-8")
    assert not record_outdated(api.open_project(folder))
    assert main(["close", str(folder), "--session", "k1", "--by", "Li"]) == 0
    said = capsys.readouterr()
    assert "results/record.pdf is out of date" in said.err
    assert "out of date" not in said.out
    assert record_outdated(api.open_project(folder))
    write_record(folder)
    assert not record_outdated(api.open_project(folder))
    assert main(["reopen", str(folder), "--session", "k1", "--reason", "x", "--json"]) == 0
    assert "out of date" in capsys.readouterr().err
    (folder / "results" / "record.pdf").write_bytes(b"%PDF of another program")
    assert record_outdated(api.open_project(folder))


def test_check_tells_a_record_that_is_out_of_date(tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    write_record(folder)
    assert "record_outdated" not in [w.code for w in api.check(folder).warnings]
    api.close(folder, by="M. Weber", now=now)
    told = [w for w in api.check(folder).warnings if w.code.startswith("record")]
    assert [w.code for w in told] == ["record_outdated"]
    assert "results/record.pdf is out of date" in told[0].text
    write_record(folder)
    assert "record_outdated" not in [w.code for w in api.check(folder).warnings]


def test_a_record_in_another_language_has_the_same_stamp(tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    project = api.open_project(folder)
    (folder / "results").mkdir()
    for language in ("en", "de", "ru", "zh"):
        api.report(folder, folder / "results" / "record.pdf", language=language)
        assert not record_outdated(project)
