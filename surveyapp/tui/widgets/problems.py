"""What is wrong with an input, in words: every problem with what was found and what to do."""

from __future__ import annotations

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import Static

from surveyapp.errors import SurveyError
from surveyapp.languages import shown
from surveyapp.report.blocks import Block, Paragraph
from surveyapp.tui import texts


class Problems(VerticalScroll):
    """All problems of an error, one below the other."""

    def __init__(self, error: SurveyError) -> None:
        super().__init__()
        self.error = error

    def compose(self) -> ComposeResult:
        """The problems as text."""
        text = Text().append(f"{texts.CANNOT_USE}\n\n", style="bold")
        yield Static(text.append_text(problems_text(self.error)), markup=False)


def problem_blocks(error: SurveyError) -> tuple[Block, ...]:
    """Every problem as paragraphs, for a pane of blocks."""
    return tuple(Paragraph(text) for text in problems_text(error).plain.split("\n\n"))


def problems_text(error: SurveyError) -> Text:
    """Every problem as a paragraph."""
    text = Text()
    for problem in error.problems:
        what = shown(problem.what)
        head = f"{shown(problem.where)}: {what}" if problem.where else what
        text.append(f"{head}\n")
        if problem.found:
            text.append(f"  {texts.FOUND.format(text=shown(problem.found))}\n")
        if problem.expected:
            text.append(f"  {texts.EXPECTED.format(text=shown(problem.expected))}\n")
        if problem.hint:
            text.append(f"  {shown(problem.hint)}\n")
        text.append("\n")
    text.rstrip()
    return text
