"""One presentation: the command, the screens and the record show the same blocks in one order."""

from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.orient import orientation_text
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.report.blocks import Block, ForWidth, Table, on_page, without_figures
from surveyapp.report.record import Record, record_document
from surveyapp.report.result import result_blocks
from surveyapp.report.text import blocks_text
from surveyapp.tui.views.blocks import blocks_as_text
from surveyapp.tui.views.project import LISTS, details_of, page_rows

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
    tables = {block.head: block.rows for block in every_table(result_blocks(project, result))}
    pages = page_rows(project, result)
    for page in ("sessions", "checks", *(["lines"] if result.lines else [])):
        rows = tables[LISTS[page][0]]
        assert pages[page][: len(rows)] == list(rows)
    document = without_figures(result_blocks(project, result, reduction=True))
    text = " ".join(words(blocks_text(document, WIDTH)))
    for page, count in (("sessions", len(result.sessions)), ("lines", len(result.lines))):
        for row in range(count):
            for line in details_of(project, result, page, row, width=WIDTH - 2).plain.splitlines():
                assert " ".join(words(line)) in text


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
