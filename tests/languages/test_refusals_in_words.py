"""What is refused is said in the reader's language; exit codes and JSON are the same for all."""

from __future__ import annotations

import ast
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from scripts import extract_texts, problem_texts
from surveyapp.cli.main import main
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import in_language, shown

ROOT = Path(__file__).resolve().parents[2]


def test_every_refusal_can_be_said_in_another_language() -> None:
    """No text with values in it reaches a Problem or a warning other than through ``said``."""
    lost = [
        f"{path.name}:{expression.lineno}: {text}"
        for path, found in extract_texts.refusals()[1].items()
        for expression, text in found.unsaid
        if isinstance(expression, ast.JoinedStr) and problem_texts.has_words(_literal(expression))
    ]
    assert lost == []


def _literal(text: ast.JoinedStr) -> str:
    return "".join(str(v.value) if isinstance(v, ast.Constant) else "{}" for v in text.values)


@pytest.mark.parametrize(
    ("source", "texts", "unsaid"),
    [
        (
            "raise Problem('a is wrong', w, f, 'an other')",
            {"a is wrong", "an other"},
            0,
        ),
        (
            "def f(x):\n    hint = 'try' if x else 'go'\n    Problem(w, w, hint=hint)",
            {"try", "go"},
            0,
        ),
        ("def g(what):\n    raise Problem(what)\ndef h():\n    g('handed')", {"handed"}, 0),
        ("Problem(f'{x} is wrong')", set(), 1),
        (
            "def w(code, text):\n    ResultWarning(code, text)\nw('c', 'mind it')",
            {"mind it"},
            0,
        ),
        ("found = Problem('one', where='a place', found='two words')", {"one"}, 0),
    ],
)
def test_texts_are_found_by_their_place(source: str, texts: set[str], unsaid: int) -> None:
    (found,) = problem_texts.texts_of({Path("x.py"): ast.parse(source)}).values()
    assert {text for text, _ in found.texts} == texts
    assert len(found.unsaid) == unsaid


def test_the_catalogues_translate() -> None:
    """A text that stands in every catalogue as in English is one of keys, options and formulas."""
    known = extract_texts.texts()
    entries = [extract_texts.catalogue(language) for language in ("de", "ru", "zh")]
    same = [
        key[0]
        for key in known
        if all(key in one and one[key][0] == key[0] for one in entries)
        and problem_texts.has_words(key[0])
    ]
    assert len(same) < 0.02 * len(known), same


REFUSED: dict[str, Callable[[Path], list[str]]] = {
    "no such folder": lambda folder: ["orient", str(folder / "nowhere")],
    "no such option": lambda _folder: ["check", "--seel", "x"],
    "value missing": lambda _folder: ["orient", "--session"],
    "unknown session": lambda folder: ["orient", str(_project(folder)), "--session", "no-such"],
    "book with a wrong row": lambda folder: ["orient", str(_project(folder, broken=True))],
}


def _project(folder: Path, *, broken: bool = False) -> Path:
    shutil.copytree(ROOT / "projects" / "gi-b1-1966", folder / "p")
    if broken:
        book = next((folder / "p" / "observations").glob("*.csv"))
        lines = book.read_text(encoding="utf-8").splitlines(keepends=True)
        lines[3] = lines[3].replace(",", ";", 1).replace("reversal", "reversed")
        book.write_text("".join(lines), encoding="utf-8")
    return folder / "p"


@pytest.mark.parametrize("case", REFUSED)
def test_a_refusal_follows_the_language_and_its_json_does_not(
    case: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    arguments = REFUSED[case](tmp_path)
    said, objects = {}, {}
    for language in ("en", "de", "ru", "zh"):
        monkeypatch.setenv("LANGUAGE", language)
        assert main(arguments) == 2
        said[language] = capsys.readouterr().err
        assert main([*arguments, "--json"]) == 2
        objects[language] = json.loads(capsys.readouterr().out)
    assert all(objects[language] == objects["en"] for language in objects)
    assert len(set(said.values())) == 4
    for problem in objects["en"]["problems"]:
        assert problem["what"] in said["en"]
        assert problem["what"] not in said["de"] + said["ru"] + said["zh"]
    assert any("а" <= letter <= "я" for letter in said["ru"])
    assert any("\u4e00" <= letter <= "\u9fff" for letter in said["zh"])


def test_a_problem_is_one_sentence_in_every_language() -> None:
    problem = Problem("the file does not exist", "a.csv", "nothing", "an existing file")
    error = SurveyError([problem, Problem("this is no number", "b.csv")])
    assert str(error) == error.text
    with in_language("de"):
        assert shown(error.text) == (
            "a.csv: die Datei existiert nicht; gefunden nothing; erwartet eine vorhandene Datei\n"
            "b.csv: das ist keine Zahl"
        )
    assert problem.to_dict()["what"] == "the file does not exist"
    assert type(json.loads(json.dumps(problem.to_dict()))["what"]) is str


def test_problems_that_are_too_many_are_counted_once() -> None:
    first = SurveyError(Problem(f"row {i}") for i in range(30_000))
    assert [p.what for p in first.problems[199:]] == ["row 199", "29800 further problems"]
    again = SurveyError([Problem("before"), *first.problems])
    assert len(again.problems) == 201
    assert again.problems[-1].what == "29801 further problems"
