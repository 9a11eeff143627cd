"""What is printed holds no English in another language: a language of one letter shows it.

In that language every letter of a text of the catalogue is a Cyrillic one and everything put into a
text is as it is, so that Latin letters stand only where a name, an id or a unit of a file does, or
where a text was never given to the catalogue.
"""

from __future__ import annotations

import re
import string
from pathlib import Path

import pytest

from scripts import extract_texts
from surveyapp import api, languages
from surveyapp.api import office
from surveyapp.cli.main import main
from surveyapp.domain.advance import silent
from surveyapp.report.blocks import Document
from surveyapp.report.in_words import in_words
from surveyapp.report.text import blocks_text

ROOT = Path(__file__).resolve().parents[2]
LETTER = "ж"
GIVEN = {
    "gi-b1-1966": {"MOM", "Gi-B", "gyrotheodolite", "mom-gi-b", "GiB", "surveyapp", "round", "json"}
    | {"dms", "div", "reversal", "fit"},
    "johannesburg-1966": {"Johannesburg", "GAK", "Wild", "gyro", "attachment", "wild-gak"}
    | {"Williams", "and", "Belling", "University", "Pillar", "run", "reversal"}
    | {"surveyapp", "Durbin-Watson", "dms", "fit"},
}
"""Names of the projects, of their instruments, and kinds and units as the books write them."""
NEVER = re.compile(r"[\w.]*[._/\[\]][\w.\[\]]*|[0-9a-f]{6,}|\S*\d\S*")
"""Ids of checks and of numbers, paths and digests."""


def _pseudo(template: str) -> str:
    try:
        parts = list(string.Formatter().parse(template))
    except ValueError:
        parts = [(template, None, None, None)]
    out = []
    for literal, name, spec, _ in parts:
        marked = re.sub(r"[^\W\d_]", LETTER, literal)
        if name is None:
            out.append(marked)
        else:
            out.append(marked.replace("{", "{{").replace("}", "}}"))
            out.append(f"{{{name}:{spec}}}" if spec else f"{{{name}}}")
    return "".join(out)


@pytest.fixture(scope="module")
def pseudo() -> set[str]:
    return {text for key in extract_texts.catalogue("de") for text in key if text}


@pytest.fixture
def marked(pseudo: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def told(template: str, plural: str | None, count: int) -> str:
        chosen = template if plural is None or count == 1 else plural
        return _pseudo(chosen) if template in pseudo else chosen

    monkeypatch.setattr(languages, "_translate", told)
    monkeypatch.setenv("LANGUAGE", "de")


def _left(text: str, given: set[str]) -> set[str]:
    words = re.findall(r"[A-Za-z][A-Za-z-]*[A-Za-z]{2}", NEVER.sub(" ", text))
    return {word for word in words if word.strip("-") not in given}


def _document(name: str) -> Document:
    found = api.compute(ROOT / "projects" / name)
    return office._record(found, office._diagnoses(found, silent))[0]


@pytest.mark.parametrize("name", GIVEN)
@pytest.mark.usefixtures("marked")
def test_a_record_with_its_diagnosis_holds_no_english(name: str) -> None:
    document = _document(name)
    numbers = next(
        i for i, block in enumerate(document.blocks) if "Annex" in str(getattr(block, "text", ""))
    )
    with languages.in_language("de"):
        shown = in_words(document)
        text = "\n".join((shown.title, *shown.foot, blocks_text(shown.blocks[:numbers])))
    assert text.count(LETTER) > 3000
    assert _left(text, GIVEN[name]) == set()


@pytest.mark.parametrize("command", ["orient", "check", "diagnose"])
@pytest.mark.usefixtures("marked")
def test_commands_print_no_english(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, str(ROOT / "projects" / "gi-b1-1966")]) in (0, 1)
    text = capsys.readouterr().out
    assert text.count(LETTER) > 50
    assert _left(text, GIVEN["gi-b1-1966"]) == set()


def test_what_is_left_is_found() -> None:
    assert _left("жжж warm-up жж Johannesburg sessions[0] midpoint_step", {"Johannesburg"}) == {
        "warm-up"
    }
