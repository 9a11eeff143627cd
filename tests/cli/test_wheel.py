"""What travels in the wheel: the program works from it without the checkout."""

import zipfile
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    folder = tmp_path_factory.mktemp("wheel")
    built = list(WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"]))
    with zipfile.ZipFile(built[0]) as wheel:
        return set(wheel.namelist())


def inside(names: set[str], folder: str) -> set[str]:
    return {name.removeprefix(folder) for name in names if name.startswith(folder)}


def test_every_file_of_the_samples_travels(names: set[str]) -> None:
    projects = ROOT / "projects"
    kept = {
        str(path.relative_to(projects))
        for path in projects.rglob("*")
        if path.is_file() and "results" not in path.parts
    }
    assert any(name.endswith("SOURCE.md") for name in kept)
    assert kept - {"ledger.jsonl"} <= inside(names, "surveyapp/samples/")


@pytest.mark.parametrize("kind", ["instruments", "tolerances"])
def test_every_card_and_rule_book_travels(names: set[str], kind: str) -> None:
    cards = {path.name for path in (ROOT / "models" / "surveyapp_models" / kind).glob("*.toml")}
    assert cards
    assert inside(names, f"surveyapp_models/{kind}/") >= cards


def test_modules_style_sheets_and_type_markers_travel(names: set[str]) -> None:
    for source, package in ((ROOT, "surveyapp"), (ROOT / "models", "surveyapp_models")):
        files = {
            str(path.relative_to(source))
            for pattern in ("*.py", "*.tcss", "py.typed")
            for path in (source / package).rglob(pattern)
        }
        assert f"{package}/py.typed" in files
        assert files <= names, files - names
    assert "surveyapp/tui/app.tcss" in names


def test_the_wheel_claims_two_packages_and_one_command(names: set[str]) -> None:
    top = {name.partition("/")[0] for name in names}
    assert {name for name in top if not name.endswith(".dist-info")} == {
        "surveyapp",
        "surveyapp_models",
    }
    assert any(name.endswith("entry_points.txt") for name in names)
