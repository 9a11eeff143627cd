"""Test files of one name cannot be collected together."""

import re
from collections import Counter
from pathlib import Path


def test_every_test_file_has_a_name_of_its_own() -> None:
    names = Counter(path.name for path in Path(__file__).parents[1].rglob("test_*.py"))
    assert [name for name, count in names.items() if count > 1] == []


ONE_CONCEPT = (
    *("Problem", "SurveyError", "Observation", "Progress", "Subject", "Circumstances"),
    *("Determination", "Quantity", "DampedFit", "fit_damped_swing", "RunPoints", "Floats"),
    *("student_quantile", "chi_square_quantile", "orient_project", "NORMAL_95", "FIT_KIND"),
)
"""What had two definitions once, or five: each has one."""


def test_one_concept_has_one_definition_and_one_name() -> None:
    root = Path(__file__).parents[2]
    paths = [p for room in ("surveyapp", "models") for p in (root / room).rglob("*.py")]
    sources = [path.read_text(encoding="utf-8") for path in paths]
    defined = re.compile(r"^(?:class|def) (\w+)|^(\w+)(?:: [^=\n]+)? = ", re.MULTILINE)
    names = Counter(a or b for text in sources for a, b in defined.findall(text))
    assert {name: names[name] for name in ONE_CONCEPT} == dict.fromkeys(ONE_CONCEPT, 1)
    aliases = re.compile(
        r"import [^\n]*\b(?:Problem|SurveyError|Floats|Quantity|Observation) as \w+"
    )
    assert [found for text in sources for found in aliases.findall(text)] == []
