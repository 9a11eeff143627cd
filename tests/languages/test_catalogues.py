"""Every text of the screens and the record stands in every catalogue, and fits its English."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from pypdf import PdfReader

from scripts import extract_texts
from surveyapp import api, languages
from surveyapp.report.text import display_width
from surveyapp.tui.texts import help_texts
from surveyapp.tui.texts import session as session_texts
from surveyapp.workflows.computing import Computed

ROOT = Path(__file__).resolve().parents[2]
OTHERS = ("de", "ru", "zh")
WIDEST_HELP, LONGEST_HELP = 74, 18
LETTERS = {"de": "äöüÄÖÜß", "ru": "абвгдежзийклмнопрстуфхцчшщъыьэюя", "zh": "陀螺方位角检核"}


@pytest.fixture(scope="module")
def computed() -> Computed:
    return api.compute(ROOT / "projects" / "tongjin-2015")


def test_catalogues_are_complete_and_fit() -> None:
    known = extract_texts.texts()
    assert len(known) > 1500
    for language in OTHERS:
        assert extract_texts.faults(language, known) == [], (
            f"{language}: run python -m scripts.extract_texts --write and translate what is empty"
        )


def test_what_does_not_fit_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    known = {
        ("{a} of {b:.1f}", None): "x.py",
        ("one {count}", "many {count}"): "x.py",
        ("  two", None): "x.py",
        ("lost", None): "x.py",
    }
    entries = {
        ("{a} of {b:.1f}", None): ("{a} von {b:.2f}",),
        ("one {count}", "many {count}"): ("ein", "viele {count}"),
        ("  two", None): ("zwei",),
        ("gone", None): ("fort",),
    }
    monkeypatch.setattr(extract_texts, "catalogue", lambda _language: entries)
    found = extract_texts.faults("de", known)
    assert [text.split(":")[0] for text in found] == [
        "missing",
        "stale",
        "other fields",
        "other spaces at the ends",
    ]
    assert len(
        [text for text in extract_texts.faults("ru", known) if "2 forms instead of 3" in text]
    )


@pytest.mark.parametrize("language", OTHERS)
def test_pages_of_help_fit_the_smallest_screen(language: str) -> None:
    with languages.in_language(language):
        pages = {name: help_texts.page_of(name) for name in help_texts.PAGES}
        hints = [languages.translated(text) for text in session_texts.STEP_HINTS.values()]
    for name, page in pages.items():
        assert page is not None
        lines = page[1].splitlines()
        assert max(map(display_width, lines)) <= WIDEST_HELP, name
        assert len(lines) <= LONGEST_HELP, name
    assert max(display_width(line) for text in hints for line in text.split("\n")) <= 58


@pytest.mark.parametrize("language", OTHERS)
def test_names_of_kinds_are_split_as_in_english(language: str) -> None:
    """The entry line asks for the kind before the comma and shows the unit behind it."""
    for english in session_texts.KIND_NAMES.values():
        with languages.in_language(language):
            told = languages.translated(english)
        assert (", " in told) == (", " in english), told


@pytest.mark.parametrize("language", OTHERS)
def test_the_record_in_every_language_reads_back(
    language: str, tmp_path: Path, computed: Computed
) -> None:
    """The PDF holds the words of the language and the numbers and names of the English one."""
    written = api.report(computed, tmp_path / "record.pdf", language=language)
    assert written.warnings == ()
    reader = PdfReader(io.BytesIO((tmp_path / "record.pdf").read_bytes()))
    text = "\n".join(page.extract_text() for page in reader.pages)
    whole = "".join(text.split())
    with languages.in_language(language):
        for english in (
            "grid azimuth",
            "Instrument constant (true minus gyro, astronomic terms)",
            "Signatures",
            "NOT MET",
        ):
            assert "".join(languages.translated(english).split()) in whole, english
    assert "322-18-39.9" in text
    assert "HGG05-15001" in text
    assert any(letter in text for letter in LETTERS[language])
    for english in ("where it comes from", "source of error", "Checks", "degrees of freedom"):
        assert english not in text


@pytest.mark.parametrize("language", OTHERS)
def test_a_record_and_its_json_do_not_depend_on_the_language_in_use(language: str) -> None:
    folder = ROOT / "projects" / "gi-b1-1966"
    english = api.orient(folder).to_dict()
    with languages.in_language(language):
        assert api.orient(folder).to_dict() == english
        german = api.report_text(folder, language=language)
    assert api.report_text(folder) != german


@pytest.mark.parametrize("method", ["tracking", "amplitude", "transit", "automatic"])
def test_blank_forms_are_written_in_every_language(method: str, tmp_path: Path) -> None:
    sizes = {
        language: api.blank_form(method, tmp_path / "form.pdf", language=language).sha256
        for language in languages.LANGUAGES
    }
    assert len(set(sizes.values())) == len(sizes)
