"""What comes in kinds stands in one tuple; what is new there comes out everywhere."""

from __future__ import annotations

from pathlib import Path

import pytest

from scripts import toys
from surveyapp import api
from surveyapp.cli.main import COMMANDS, parser_of
from surveyapp.core.checks.verdicts import CHECKS, CheckGroup
from surveyapp.core.network.linearise import EQUATIONS
from surveyapp.domain.observations import KINDS, KindOfObservation, ObservationKind
from surveyapp.io.exporters.catalogue import EXPORTERS, Exporter
from surveyapp.io.importers.fieldfiles.catalogue import IMPORTERS, Importer
from surveyapp.io.traverse.rows import parse_traverse
from surveyapp.observation.exchange import export_formats
from surveyapp.report.record import SECTIONS, Section
from surveyapp_models.angles import AngleUnit

Named = Importer | Exporter | CheckGroup | Section
ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "docs" / "reference"
NAMES = {
    "formats": [*(item.id for item in IMPORTERS), *(item.id for item in EXPORTERS)],
    "checks": [item.id for item in CHECKS],
    "record-sections": [item.id for item in SECTIONS],
    "traverse-observations": [str(item.kind) for item in KINDS if item.book],
}
EFFORT = {
    "effect with a new campaign column": (1, 2, 2),
    "check": (1, 1, 1),
    "importer": (1, 1, 1),
    "exporter": (1, 1, 1),
    "command": (1, 1, 1),
    "result field": (0, 5, 4),
    "section of the record": (1, 1, 1),
    "kind of observation of a traverse": (0, 3, 2),
}
"""New files, places and files in which something stands more; docs/explanation/architecture.md."""


def test_every_toy_comes_out_at_the_other_end_with_few_places(tmp_path: Path) -> None:
    toys.perform(tmp_path)
    assert {t.name: (len(t.files), len(t.places), t.touched) for t in toys.TOYS} == EFFORT
    page = (ROOT / "docs/explanation/architecture.md").read_text(encoding="utf-8")
    for name, (new, places, files) in EFFORT.items():
        assert f"| {name} | {new} | {places} | {files} |" in page


@pytest.mark.parametrize("page", NAMES)
def test_names_are_unique_and_stand_on_their_page(page: str) -> None:
    text = (REFERENCE / f"{page}.md").read_text(encoding="utf-8")
    assert all(name in text for name in NAMES[page])


@pytest.mark.parametrize("catalogue", [IMPORTERS, EXPORTERS, CHECKS, SECTIONS])
def test_no_name_stands_twice(catalogue: tuple[Named, ...]) -> None:
    names = [item.id for item in catalogue]
    assert len(set(names)) == len(names) > 3
    assert all(item.title for item in catalogue)


def choices(name: str) -> list[str]:
    command = next(item for item in COMMANDS if item.name == name)
    (action,) = [a for a in parser_of(command)._actions if a.dest == "format"]
    assert all(form in (action.help or "") for form in action.choices or ())
    return list(action.choices or ())


def test_command_line_and_screens_take_their_formats_from_the_catalogues() -> None:
    assert choices("import") == [item.id for item in IMPORTERS]
    assert choices("export") == [item.id for item in EXPORTERS] == list(export_formats())


@pytest.mark.parametrize("item", IMPORTERS, ids=lambda item: item.id)
def test_an_importer_reads_pointings_or_azimuths(item: Importer) -> None:
    assert (item.pointings is None) != (item.azimuths is None)


@pytest.mark.parametrize("form", [item.id for item in EXPORTERS if item.write is not None])
def test_an_exporter_writes_the_sample(form: str, tmp_path: Path) -> None:
    out = tmp_path / f"out.{form}"
    api.export_survey(form, ROOT / "projects" / "synthetic-breakthrough", out)
    assert out.stat().st_size > 0


def test_an_exporter_without_a_writer_has_a_function_of_the_api() -> None:
    for item in EXPORTERS:
        assert item.write is not None or callable(getattr(api, f"export_{item.id}"))


def test_every_kind_of_observation_has_its_entry_and_its_equation() -> None:
    assert [item.kind for item in KINDS] == list(ObservationKind)
    assert [item.kind for item in EQUATIONS] == list(ObservationKind)
    assert all(len(e.touches) + e.shares <= 6 for e in EQUATIONS)


@pytest.mark.parametrize("item", [k for k in KINDS if k.book], ids=lambda item: str(item.kind))
def test_a_row_of_every_kind_is_read(item: KindOfObservation) -> None:
    value = "" if item.book == "none" else "50-00-00" if item.angular else "12.345"
    text = f"kind,at,from,to,value,sigma\n{item.kind},A,B,C,{value},2.0\n"
    (row,), problems = parse_traverse(text, angle_unit=AngleUnit.DMS, where="book")
    assert problems == []
    assert (row.kind, row.value is None) == (item.kind, item.book == "none")
    assert row.sigma == pytest.approx(2.0 * 4.84813681109536e-6 if item.angular else 0.002)
