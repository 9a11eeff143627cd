"""A folder that is no project: every command that takes one refuses it in words."""

from pathlib import Path

import pytest

from surveyapp.io.exporters.catalogue import EXPORTERS
from tests.cli.command import good_project, run


@pytest.mark.parametrize("name", ["absent", "empty", "a file"])
@pytest.mark.parametrize("form", sorted(item.id for item in EXPORTERS))
def test_export_of_what_is_no_project_is_refused(tmp_path: Path, form: str, name: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "a file").write_text("x", encoding="utf-8")
    output = tmp_path / "out"
    outcome = run("export", form, tmp_path / name, output, "--json")
    assert outcome.code == 2, outcome.out
    assert outcome.json["schema"] == "surveyapp.error/1"
    assert outcome.json["problems"][0]["what"]
    assert not output.exists()


def test_project_that_cannot_be_read_is_still_handed_over(tmp_path: Path) -> None:
    folder = good_project(tmp_path / "p", toml="format = 1\nname = 3\n")
    assert run("orient", folder, "--json").code == 2
    outcome = run("export", "zip", folder, tmp_path / "p.zip", "--json")
    assert outcome.code == 0, outcome.out
    assert outcome.json["items"] == 2
