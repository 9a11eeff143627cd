"""Arabic, Hebrew and Thai are drawn in their order and forms, or told; nothing is a box."""

from __future__ import annotations

from pathlib import Path

import pytest
from pypdf import PdfReader

from surveyapp import api
from surveyapp.report import faces
from surveyapp.report.pdf import bidi, fonts
from surveyapp.report.pdf.fonts import BASE, register_faces, undrawn
from tests.tui.helpers_tui import PROJECT, make_project

HEBREW = "\u05ea\u05d7\u05e0\u05d4"  # TAV HET NUN HE
ARABIC = "\u0645\u062d\u0637\u0629"  # MEEM HAH TAH TEH-MARBUTA
THAI = "\u0e2a\u0e16\u0e32\u0e19\u0e35"


def test_hebrew_is_drawn_from_right_to_left_and_a_number_left_of_it() -> None:
    assert bidi.drawn_order(HEBREW) == HEBREW[::-1]
    # UAX 9: digits after a right-to-left word keep their own order and stand at its left
    assert bidi.drawn_order(f"{HEBREW} 12") == f"12\u00a0{HEBREW[::-1]}"
    assert bidi.drawn_order(f"A {HEBREW} B") == f"A {HEBREW[::-1]} B"


def test_a_line_keeps_its_station_at_the_left() -> None:
    drawn = bidi.drawn_order(f"{HEBREW} 1 - {ARABIC} 2")
    first, second = drawn.split(" - ")
    assert first == f"1\u00a0{HEBREW[::-1]}"
    assert second.startswith("2\u00a0")


def test_arabic_letters_take_their_joined_forms() -> None:
    # Unicode chart Arabic Presentation Forms-B: MEEM initial FEE3, HAH medial FEA4,
    # TAH medial FEC4, TEH MARBUTA final FE94; drawn from the right
    assert bidi.drawn_order(ARABIC) == "\ufe94\ufec4\ufea4\ufee3"


def test_a_long_text_is_parted_at_blanks_and_keeps_its_words_in_order() -> None:
    text = " ".join([HEBREW] * 20)
    drawn = bidi.drawn_order(text)
    lines = drawn.split(" ")
    assert len(lines) > 1
    assert all(len(line) <= bidi.LINE for line in lines)
    assert sum(line.count(HEBREW[::-1]) for line in lines) == 20


def test_each_writing_has_its_face_and_latin_stays_in_the_base() -> None:
    found = register_faces(None)
    for text, part in ((HEBREW, "Heebo"), (ARABIC, "Arabic"), (THAI, "Thai")):
        ((name, _),) = found.split(text)
        assert part in name
    assert found.split("K12") == [(BASE, "K12")]
    assert not found.missing
    # signs that choose a variant of an emoji or join letters are not drawn, so not missing
    assert undrawn([f"{ARABIC}\u200c{ARABIC}"]) == ()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = make_project(tmp_path / "p")
    text = (place / "project.toml").read_text("utf-8")
    text = text.replace("Ramp 3", f"{THAI} {ARABIC}").replace('"3090"', f'"{HEBREW} 7"')
    text = text.replace("[[instrument]]", f'[[station]]\nname = "{ARABIC} 7"\n\n[[instrument]]', 1)
    (place / "project.toml").write_text(text, "utf-8")
    book = place / "observations" / "r1.csv"
    rows = [f"{k},,,reversal,{179 + 2 * (k % 2)}-00-1{k},,,{'LR'[k % 2]},,,\n" for k in range(1, 6)]
    book.write_text(book.read_text("utf-8") + "".join(rows), "utf-8")
    assert "Ramp 3" in PROJECT
    return place


def test_the_record_prints_all_names(folder: Path, tmp_path: Path) -> None:
    written = api.report(folder, tmp_path / "r.pdf")
    assert written.to_dict()["missing_glyphs"] == []
    reader = PdfReader(written.path)
    text = "".join(page.extract_text() for page in reader.pages)
    assert HEBREW in text or HEBREW[::-1] in text  # extraction may turn it back
    forms = "\ufe94\ufec4\ufea4\ufee3"
    assert forms in text or forms[::-1] in text
    embedded = {
        str(font.get_object()["/BaseFont"])
        for page in reader.pages
        for font in page["/Resources"]["/Font"].values()  # type: ignore[index]
    }
    assert any("Arabic" in name for name in embedded)
    again = api.report(folder, tmp_path / "again.pdf")
    assert again.sha256 == written.sha256


def test_without_the_libraries_it_is_told_and_no_two_names_look_alike(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bidi, "can_order", lambda: False)
    monkeypatch.setattr(fonts, "can_order", lambda: False)
    written = api.report(folder, tmp_path / "r.pdf")
    told = {item["text"] for item in written.to_dict()["missing_glyphs"]}
    assert {f"{ARABIC} 7", f"{HEBREW} 7"} <= told
    assert "surveyapp[glyphs]" in written.warnings[0].text
    text = "".join(page.extract_text() for page in PdfReader(written.path).pages)
    assert "[0645][062D][0637][0629] 7" in text
    assert "[05EA][05D7][05E0][05D4] 7" in text


def test_without_any_further_face_the_codes_stand_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts, "further_faces", lambda: iter(()))
    monkeypatch.setattr(fonts, "wide_face", lambda: None)
    for text in (HEBREW, ARABIC, THAI):
        ((_, letters),) = undrawn([text])
        assert letters == "".join(sorted(set(text)))


def test_a_folder_of_faces_may_be_named(tmp_path: Path) -> None:
    package = next(path for path in faces.further_faces() if "Heebo" in path.name)
    own = tmp_path / "faces"
    own.mkdir()
    (own / "own.ttf").write_bytes(package.read_bytes())
    (own / "broken.ttf").write_bytes(b"no face")
    found = register_faces(own)
    assert found.split(HEBREW)[0][0] == "Named-own"
    (own / "own.ttf").unlink()
    with pytest.raises(api.SurveyError, match="no face that can be embedded"):
        register_faces(own)
