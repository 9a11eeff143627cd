"""What a stranger calls a station, a project or an instrument is no formula of a spreadsheet."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.domain.records import not_a_formula

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("text", "cell"),
    [
        ("=1+2", "'=1+2"),
        ("@SUM(A1)", "'@SUM(A1)"),
        ("+1-2", "'+1-2"),
        ("-1-2", "'-1-2"),
        ("-r1", "'-r1"),
        ("\t=1", "'\t=1"),
        ("-1.5", "-1.5"),
        ("+0.02e-3", "+0.02e-3"),
        ("A=1", "A=1"),
        ("", ""),
    ],
)
def test_a_text_that_begins_like_a_formula_is_quoted(text: str, cell: str) -> None:
    assert not_a_formula(text) == cell


def test_a_table_of_many_projects_holds_no_formula(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    (folder / "observations").mkdir(parents=True)
    text = (ROOT / "projects" / "gi-b1-1966" / "project.toml").read_text(encoding="utf-8")
    named = text.replace('name = "', 'name = "=1+', 1)
    assert named != text
    (folder / "project.toml").write_text(named, encoding="utf-8")
    for book in (ROOT / "projects" / "gi-b1-1966" / "observations").iterdir():
        (folder / "observations" / book.name).write_bytes(book.read_bytes())
    api.batch([folder], tmp_path / "table.csv", jobs=1)
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as stream:
        row = next(csv.DictReader(stream))
    assert row["status"] in ("good", "limit")
    assert row["name"].startswith("'=1+")
