"""One presentation: the command, the screens and the record show the same blocks in one order."""

from collections.abc import Callable
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.orient import orientation_text
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.observation.sensors.tasks import examine
from surveyapp.report.blocks import Block, ForWidth, Table, on_page, without_figures
from surveyapp.report.record import Record, record_document
from surveyapp.report.result import result_blocks
from surveyapp.report.sections import diagnosis as diagnosis_section
from surveyapp.report.sections import penetration as penetration_section
from surveyapp.report.sections import shafts as shaft_section
from surveyapp.report.sections import traverse as traverse_section
from surveyapp.report.sections.sensors import allan_blocks
from surveyapp.report.text import blocks_text
from surveyapp.tui.views import penetration as penetration_view
from surveyapp.tui.views import shafts as shaft_view
from surveyapp.tui.views import traverse as traverse_view
from surveyapp.tui.views.blocks import blocks_as_text
from surveyapp.tui.views.diagnosis import diagnosis_blocks
from surveyapp.tui.views.project import details_of, page_tables
from surveyapp_models.angles import AngleUnit

PROJECTS = Path(__file__).parents[2] / "projects"
WIDTH = 80


@pytest.fixture(scope="module", params=["tongjin-2015", "johannesburg-1966"])
def oriented(request: pytest.FixtureRequest) -> tuple[Project, OrientationResult]:
    project = api.open_project(PROJECTS / request.param)
    return project, api.orient(project)


Oriented = tuple[Project, OrientationResult]


def words(text: str) -> list[str]:
    return text.split()


def test_the_record_holds_every_block_of_the_command_in_its_order(oriented: Oriented) -> None:
    project, result = oriented
    whole = iter(record_document(Record(project, result))[0].blocks)
    made = result_blocks(project, result, reduction=True)
    assert len(made) > 10
    for block in made:
        assert block in whole, block  # and so behind the one before it


def test_the_command_and_a_screen_print_the_same_words(oriented: Oriented) -> None:
    project, result = oriented
    made = without_figures(result_blocks(project, result))
    printed = orientation_text(project, result)
    assert printed.endswith(blocks_text(made, WIDTH))
    rules = {"-", "."}
    told = [word for word in words(blocks_text(made, WIDTH)) if set(word) - rules or word == "-"]
    assert sorted(words(blocks_as_text(made, WIDTH).plain)) == sorted(told)


def test_lists_and_details_of_the_screens_are_blocks_of_the_record(oriented: Oriented) -> None:
    project, result = oriented
    made = result_blocks(project, result, reduction=True)
    tables = every_table(result_blocks(project, result))
    pages = page_tables(project, result)
    for page in ("sessions", "checks", *(["lines"] if result.lines else [])):
        shown = pages[page]
        found = [table for table in tables if table.head == shown.head]
        assert found, page
        assert list(shown.rows[: len(found[0].rows)]) == list(found[0].rows)
    for page, count in (("sessions", len(result.sessions)), ("lines", len(result.lines))):
        for row in range(count):
            details = details_of(project, result, page, row)
            assert details
            assert set(details) <= set(made)


Pages = dict[str, tuple[Block, ...]]


def of_traverse() -> tuple[Pages, tuple[Block, ...]]:
    computed = api.compute(PROJECTS / "synthetic-breakthrough")
    result, unit = api.adjust(computed), computed.project.angle_unit
    pages = traverse_view.pages(result, computed.result.checks, unit)
    (checks,) = pages.pop("checks")
    assert checks == page_tables(computed.project, computed.result)["checks"]
    return pages, traverse_section.blocks("all", result, unit=unit)


def of_breakthrough() -> tuple[Pages, tuple[Block, ...]]:
    found = api.predict(PROJECTS / "synthetic-breakthrough", monte_carlo=False)
    return penetration_view.pages(found), penetration_section.blocks(found)


def of_shafts() -> tuple[Pages, tuple[Block, ...]]:
    result = api.shaft(PROJECTS / "synthetic-breakthrough")
    (shaft,) = result.shafts
    pages = shaft_view.pages(result, shaft, AngleUnit.DMS)
    return pages, shaft_section.blocks(result, unit=AngleUnit.DMS)


def of_diagnosis() -> tuple[Pages, tuple[Block, ...]]:
    project = api.open_project(PROJECTS / "johannesburg-1966")
    session = next(s.id for s in api.subjects(project) if s.keyword == "session")
    found = api.diagnose(project, session=session, log=False)
    assert found.diagnosis is not None
    record = diagnosis_section.blocks(found.diagnosis, found.words, {}, unit=project.angle_unit)
    shown = diagnosis_blocks(found, project.angle_unit)
    bars = [shown.index(block) for block in shown if block not in record]
    assert bars == list(range(bars[0], bars[0] + 2 * len(found.channels)))  # the figures drawn
    return {"diagnosis": tuple(block for block in shown if block in record)}, record


def of_sensor_log() -> tuple[Pages, tuple[Block, ...]]:
    folder = str(PROJECTS / "mpu6050-static")
    (entry, *_) = api.open_project(folder).sensor_logs
    found = examine(folder, entry, "allan", "")
    return {"result": found.blocks}, allan_blocks(entry.id, api.allan(folder, sensor=entry.id))


@pytest.mark.parametrize(
    "of", [of_traverse, of_breakthrough, of_shafts, of_diagnosis, of_sensor_log]
)
def test_every_page_of_a_screen_is_made_of_blocks_of_the_record(
    of: Callable[[], tuple[Pages, tuple[Block, ...]]],
) -> None:
    pages, record = of()
    known = {part for block in record for part in (block, *narrow_of(block))}
    for page, blocks in pages.items():
        assert set(blocks) <= known, page
    assert sum(map(len, pages.values())) > 2


def narrow_of(block: Block) -> tuple[Block, ...]:
    return block.narrow if isinstance(block, ForWidth) else ()


def every_table(blocks: tuple[Block, ...]) -> list[Table]:
    return [
        item
        for block in blocks
        for item in (block.narrow if isinstance(block, ForWidth) else (block,))
        if isinstance(item, Table)
    ]


def test_a_page_has_the_wide_form_and_a_terminal_the_narrow_one() -> None:
    block = ForWidth((Table(("a", "b"), (("1", "2"),)),), (Table(("a",), (("1",),)),))
    assert [table.head for table in on_page([block]) if isinstance(table, Table)] == [("a", "b")]
    assert words(blocks_text([block])) == ["a", "1"]


@pytest.mark.parametrize("width", [72, 80, 100])
def test_no_table_of_a_result_is_wider_than_its_terminal(oriented: Oriented, width: int) -> None:
    project, result = oriented
    made = without_figures(result_blocks(project, result, reduction=True))
    assert max(map(len, blocks_text(made, width).splitlines())) <= width
