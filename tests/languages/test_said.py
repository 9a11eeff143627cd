"""A text keeps its English for scripts and is said again in the language of the reader."""

from __future__ import annotations

import copy
import json
import pickle
from dataclasses import asdict

import pytest

from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import (
    LANGUAGES,
    Said,
    counted,
    current,
    in_language,
    joined,
    preferred,
    said,
    shown,
    translated,
)
from surveyapp.languages.po_file import read_po, translations
from surveyapp.report.blocks import Figure, Heading, KeyValues, Label, Marker, Table
from surveyapp.report.in_words import in_words

RUSSIAN = """
msgid ""
msgstr ""
"Content-Type: text/plain; charset=UTF-8\\n"
"Plural-Forms: nplurals=3; plural=(n%10==1 && n%100!=11 ? 0 : "
"n%10>=2 && n%10<=4 && (n%100<10 || n%100>=20) ? 1 : 2);\\n"

#, fuzzy
msgid "guessed"
msgstr "угадано"

msgid "{name} before {value:+.1f}"
msgstr "{value:+.1f} до {name}"

msgid "{count} check"
msgid_plural "{count} checks"
msgstr[0] "{count} проверка"
msgstr[1] "{count} проверки"
msgstr[2] "{count} проверок"
"""


def test_a_text_is_its_english_for_everybody_but_the_reader() -> None:
    text = said("tape zero {value:+.3f} div, {point}", value=-0.25, point=said("before"))
    assert isinstance(text, Said)
    assert text == "tape zero -0.250 div, before"
    assert json.dumps({"text": text}) == '{"text": "tape zero -0.250 div, before"}'
    assert hash(text) == hash(str(text))
    warning = ResultWarning("code", text)
    assert asdict(warning)["text"] == str(text)
    others: list[Said] = [copy.deepcopy(text), pickle.loads(pickle.dumps(text))]
    for other in others:
        assert other == text
        assert other.template == text.template
        assert other.fields == text.fields


def test_texts_that_are_put_together_are_still_translated() -> None:
    whole = "L7: " + said("before") + ", " + joined("; ", (said("after"), "7 {x}"))
    assert isinstance(whole, Said)
    assert whole == "L7: before, after; 7 {x}"
    assert whole.told(
        lambda text, _plural, _count: {"before": "vor", "after": "nach"}.get(text, text)
    ) == ("L7: vor, nach; 7 {x}")


def test_a_catalogue_has_its_own_order_of_words_and_its_own_plurals() -> None:
    found = translations(read_po(RUSSIAN))

    def told(text: str) -> str:
        assert isinstance(text, Said)
        return text.told(
            lambda one, many, count: (
                found.gettext(one) if many is None else found.ngettext(one, many, count)
            )
        )

    assert told(said("{name} before {value:+.1f}", name="K7", value=2)) == "+2.0 до K7"
    assert [
        told(counted("{count} check", "{count} checks", count=n)) for n in (1, 2, 5, 11, 21, 22)
    ] == [
        "1 проверка",
        "2 проверки",
        "5 проверок",
        "11 проверок",
        "21 проверка",
        "22 проверки",
    ]
    assert told(said("guessed")) == "guessed"  # nobody has confirmed it


def test_a_translation_whose_fields_do_not_fit_leaves_english() -> None:
    text = said("{a} of {b}", a=1, b=2)
    assert isinstance(text, Said)
    assert text.told(lambda *_: "{a} von {c}") == "1 of 2"
    assert text.told(lambda *_: "{a} von {") == "1 of 2"


def test_a_broken_catalogue_is_refused_by_line() -> None:
    with pytest.raises(ValueError, match="line 2"):
        read_po('msgid "a"\nnonsense\n')


@pytest.mark.parametrize(
    ("setting", "environment", "language"),
    [
        ("", {}, "en"),
        ("", {"LANG": "de_DE.UTF-8"}, "de"),
        ("", {"LANG": "de_AT"}, "de"),
        ("", {"LANG": "C.UTF-8"}, "en"),
        ("", {"LANG": "fr_FR.UTF-8"}, "en"),
        ("", {"LANG": "de_DE", "LC_MESSAGES": "ru_RU.KOI8-R"}, "ru"),
        ("", {"LANG": "de_DE", "LC_ALL": "C"}, "en"),
        ("", {"LC_ALL": "ru_RU", "LANGUAGE": "fr:zh_CN:de"}, "zh"),
        ("", {"LANG": "zh-Hans"}, "zh"),
        ("", {"LANG": "German_Germany.1252"}, "de"),
        ("zh", {"LC_ALL": "de_DE"}, "zh"),
        ("xx", {"LC_ALL": "de_DE"}, "de"),
    ],
)
def test_the_setting_goes_before_the_locale(
    setting: str, environment: dict[str, str], language: str
) -> None:
    assert preferred(setting, environment) == language


def test_a_language_holds_as_long_as_it_is_asked_for() -> None:
    assert current() == "en"
    with in_language("de"):
        assert current() == "de"
        with in_language("no such"):
            assert current() == "en"
        assert current() == "de"
    assert current() == "en"
    assert set(LANGUAGES) == {"en", "de", "ru", "zh"}


def test_blocks_are_said_again_and_names_are_not() -> None:
    blocks = (
        Heading(said("gyro azimuth")),
        KeyValues(((said("gyro azimuth"), "gyro azimuth"),)),
        Table((said("gyro azimuth"),), (("gyro azimuth",),), strong=frozenset({0})),
        Figure(
            said("gyro azimuth"),
            1.0,
            2.0,
            (Label((0.0, 0.0), said("gyro azimuth")), Marker((1, 2))),
        ),
    )
    assert in_words(blocks) is blocks
    with in_language("de"):
        german = translated("gyro azimuth")
        told = in_words(blocks)
        assert shown("gyro azimuth") == "gyro azimuth"
    assert german != "gyro azimuth"
    assert told == (
        Heading(german),
        KeyValues(((german, "gyro azimuth"),)),
        Table((german,), (("gyro azimuth",),), strong=frozenset({0})),
        Figure(german, 1.0, 2.0, (Label((0.0, 0.0), german), Marker((1, 2)))),
    )
