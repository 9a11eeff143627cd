"""Every text of the screens and the record, and what the catalogues lack of it.

``python -m scripts.extract_texts`` prints for each language what is missing, stale or does not fit;
``--write`` puts new texts into the catalogues with an empty translation and takes stale ones out;
``--check`` ends with 1 where a catalogue is not complete.

A text is a literal of ``said``, ``counted`` and ``said_each``, a constant of
``surveyapp.tui.texts``, what stands in a ``Problem`` or a ``ResultWarning`` (``problem_texts``), or
stands in one of the tables of ``TABLES``.
"""

from __future__ import annotations

import ast
import json
import string
import sys
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Final, get_args

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "models")]

from scripts import problem_texts  # noqa: E402
from surveyapp.languages import LANGUAGES, Said  # noqa: E402
from surveyapp.languages.names import OF, QUANTITIES, WORDS, named  # noqa: E402
from surveyapp.languages.po_file import read_po  # noqa: E402
from surveyapp.languages.vocabulary import VOCABULARY  # noqa: E402
from surveyapp_models.effects.effect import Effect  # noqa: E402

Key = tuple[str, str | None]
FOLDER: Final = ROOT / "surveyapp" / "languages"
HEADERS: Final = {
    "de": "nplurals=2; plural=(n != 1);",
    "ru": (
        "nplurals=3; plural=(n%10==1 && n%100!=11 ? 0 : "
        "n%10>=2 && n%10<=4 && (n%100<10 || n%100>=20) ? 1 : 2);"
    ),
    "zh": "nplurals=1; plural=0;",
}
FORMS: Final = {"de": 2, "ru": 3, "zh": 1}


@cache
def refusals() -> tuple[dict[Path, ast.Module], dict[Path, problem_texts.Found]]:
    """Syntax trees of all modules, and what refusals and warnings say in each."""
    trees = {
        path: ast.parse(path.read_text(encoding="utf-8"))
        for path in sorted((ROOT / "surveyapp").rglob("*.py"))
    }
    return trees, problem_texts.texts_of(trees)


@cache
def texts() -> dict[Key, str]:
    """Every text and where it stands."""
    found: dict[Key, str] = {}
    trees, refused = refusals()
    for path, tree in trees.items():
        if path.parent.name == "texts":
            continue
        place = path.relative_to(ROOT).as_posix()
        for key, line in _said(tree):
            found.setdefault(key, f"{place}:{line}")
        for text, line in refused[path].texts:
            if problem_texts.has_words(text):
                found.setdefault((text, None), f"{place}:{line}")
    for text, place in (*_screens(), *_tables()):
        if _has_words(text):
            found.setdefault((text, None), place)
    return {key: place for key, place in found.items() if _has_words(key[0])}


def _has_words(text: str) -> bool:
    """Whether letters stand outside of the fields."""
    try:
        return any(c.isalpha() for part, *_ in string.Formatter().parse(text) for c in part)
    except ValueError:
        return True


def _said(tree: ast.Module) -> Iterator[tuple[Key, int]]:
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
            continue
        name = node.func.id
        if name not in ("said", "counted", "said_each"):
            continue
        literals = [_literal(argument) for argument in node.args]
        if name == "counted":
            yield (literals[0], literals[1]), node.lineno
        else:
            for text in literals:
                yield (text, None), node.lineno


def _literal(node: ast.expr) -> str:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    raise SystemExit(
        f"line {node.lineno}: a text of the catalogue is a literal: {ast.unparse(node)}"
    )


def _screens() -> Iterator[tuple[str, str]]:
    from surveyapp.tui.texts import modules

    for module in (*modules(), "help_texts"):
        for name, value in vars(import_module(f"surveyapp.tui.texts.{module}")).items():
            if name.isupper() or (name.startswith("_") and name[1:].isupper()):
                for text in _strings(value):
                    yield text, f"surveyapp/tui/texts/{module}.py:{name}"


def _tables() -> Iterator[tuple[str, str]]:
    """Names that the screens and the record print in words, from the tables that hold them."""
    from surveyapp.core.orientation.terms import TERMS
    from surveyapp.core.penetration.covariance import Source
    from surveyapp.core.tolerance.quantities import UNITS
    from surveyapp.domain.observations import ObservationKind
    from surveyapp.domain.penetration import STEP_TITLES
    from surveyapp.domain.project import Method, Purpose
    from surveyapp.domain.shaft import CHECK_IDS
    from surveyapp_models.effects import CATALOGUE

    tables: dict[str, Iterable[str]] = {
        "core/orientation/terms.py": TERMS,
        "core/penetration/covariance.py": get_args(Source),
        "core/tolerance/quantities.py": UNITS,
        "domain/observations.py": [kind.value for kind in ObservationKind],
        "domain/penetration.py": STEP_TITLES,
        "domain/project.py": (*get_args(Method), *get_args(Purpose)),
        "domain/shaft.py": CHECK_IDS,
        "models/effects": [text for effect in CATALOGUE for text in _effect(effect)],
        "models/tolerances": _rule_books(),
        "languages/names.py": (*QUANTITIES, *OF, *WORDS),
        "languages/vocabulary.py": VOCABULARY,
    }
    for place, names in tables.items():
        for name in names:
            yield name.replace("_", " "), f"surveyapp/{place}"


def _rule_books() -> Iterator[str]:
    """Titles and clauses of the rule books that come with the program."""
    for path in sorted((ROOT / "models" / "surveyapp_models" / "tolerances").glob("*.toml")):
        book = tomllib.loads(path.read_text(encoding="utf-8"))
        yield book["title"]
        yield from (limit["clause"] for limit in book["limit"] if "clause" in limit)


def _effect(effect: Effect) -> Iterator[str]:
    """What a diagnosis says of an effect: its texts, its names in words, units that have words."""
    yield from (effect.id, effect.title, effect.title.lower())
    yield from (effect.remedy, effect.symptom, effect.separate_by)
    names = [*(c.name for c in effect.coefficients), *(g.name for g in effect.grid)]
    units = [*(c.unit for c in effect.coefficients), *(g.unit for g in effect.grid)]
    for name in (effect.id, *names):
        yield from (text for text in _leaves(named(name)) if set(text) - set("xyz"))
    yield from units
    if effect.subject in ("reversal_run", "campaign", "traverse"):
        yield from (need.unit for need in effect.needs)  # told where a project lacks it
    if effect.at_datum is not None:
        columns = {need.name: np.zeros(4) for need in effect.needs}
        states = [text for text, _ in effect.at_datum(columns, {}) if not text[0].isdigit()]
        yield from states


def _leaves(text: str) -> Iterator[str]:
    """The texts without fields that a text is made of."""
    if isinstance(text, Said):
        if not text.fields:
            yield text.template
        for value in text.fields.values():
            yield from _leaves(value)


def _strings(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for item in value.values():
            yield from _strings(item)
    elif isinstance(value, tuple):
        for item in value:
            yield from _strings(item)


def catalogue(language: str) -> dict[Key, tuple[str, ...]]:
    """What stands in a catalogue, without its header."""
    path = FOLDER / f"{language}.po"
    if not path.exists():
        return {}
    found = read_po(path.read_text(encoding="utf-8"))
    found.pop(("", None), None)
    return found


def faults(language: str, known: dict[Key, str]) -> list[str]:
    """What is missing, stale or does not fit in a catalogue."""
    entries = catalogue(language)
    found = [f"missing: {place}: {key[0]!r}" for key, place in known.items() if key not in entries]
    found += [f"stale: {key[0]!r}" for key in entries if key not in known]
    for key, translations in entries.items():
        if not all(translations):
            found.append(f"not translated: {key[0]!r}")
            continue
        forms = 1 if key[1] is None else FORMS[language]
        if len(translations) != forms:
            found.append(f"{len(translations)} forms instead of {forms}: {key[0]!r}")
        wanted = fields_of(key[0]) | (fields_of(key[1]) if key[1] else set())
        for text in translations:
            if fields_of(text) != wanted and not (key[1] and wanted - fields_of(text) <= {"count"}):
                found.append(f"other fields: {key[0]!r}: {text!r}")
            if _edges(text) != _edges(key[0]):
                found.append(f"other spaces at the ends: {key[0]!r}: {text!r}")
    return found


def fields_of(text: str) -> set[str]:
    """Fields of a template with their formats."""
    try:
        parsed = list(string.Formatter().parse(text))
    except ValueError:
        return set()
    return {f"{name}:{spec}" if spec else name for _, name, spec, _ in parsed if name is not None}


def _edges(text: str) -> tuple[str, str]:
    bare = text.strip()
    return (text[: text.find(bare)], text[text.find(bare) + len(bare) :]) if bare else (text, "")


def write(language: str, known: dict[Key, str], entries: dict[Key, tuple[str, ...]]) -> None:
    """Write a catalogue: every known text in the order of the source, with its translation."""
    head = [
        f"# {LANGUAGES[language]}: texts of the screens and the record; see the glossary",
        'msgid ""',
        'msgstr ""',
        f'"Language: {language}\\n"',
        '"Content-Type: text/plain; charset=UTF-8\\n"',
        f'"Plural-Forms: {HEADERS[language]}\\n"',
    ]
    lines = ["\n".join(head)]
    for key, place in known.items():
        forms = entries.get(key, ())
        entry = [f"#: {place.rsplit(':', 1)[0]}", f"msgid {_quoted(key[0])}"]
        if key[1] is None:
            entry.append(f"msgstr {_quoted(forms[0] if forms else '')}")
        else:
            entry.append(f"msgid_plural {_quoted(key[1])}")
            padded = (*forms, *[""] * FORMS[language])[: FORMS[language]]
            entry += [f"msgstr[{form}] {_quoted(text)}" for form, text in enumerate(padded)]
        lines.append("\n".join(entry))
    (FOLDER / f"{language}.po").write_text("\n\n".join(lines) + "\n", encoding="utf-8")


def _quoted(text: str) -> str:
    parts = text.split("\n")
    if len(parts) == 1:
        return json.dumps(text, ensure_ascii=False)
    rows = [part + "\n" for part in parts[:-1]] + ([parts[-1]] if parts[-1] else [])
    return "\n".join(['""', *(json.dumps(row, ensure_ascii=False) for row in rows)])


def main(arguments: list[str]) -> int:
    known = texts()
    complete = True
    for language in HEADERS:
        if "--write" in arguments:
            write(language, known, catalogue(language))
        told = faults(language, known)
        complete = complete and not told
        print(f"{language}: {len(known)} texts, {len(told)} faults")
        if "--write" not in arguments:
            print("\n".join(f"  {text}" for text in told))
    return 0 if complete or "--check" not in arguments else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
