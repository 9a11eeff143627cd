"""Guided programmes as rows and text: steps, what is next, what is still undetermined."""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text

from surveyapp.core.sensors.programmes.catalogue import PROGRAMMES
from surveyapp.domain.programme import Programme, ProgrammeState, ProgrammeStep, StepState
from surveyapp.languages import translated
from surveyapp.languages.names import named
from surveyapp.observation.sensors.programmes import RunShown
from surveyapp.report.blocks import Block, KeyValues, Table
from surveyapp.report.text import filled
from surveyapp.tui import texts

MOST_NAMES = 12


def run_table(runs: Sequence[RunShown]) -> Table:
    """Runs that were begun, then every programme to begin."""
    rows: list[tuple[str, ...]] = [
        (
            shown.run.id,
            texts.RUN_STEPS.format(done=shown.done, count=shown.of)
            if shown.programme.typed
            else texts.RUN_RECORDED,
            shown.programme.title,
        )
        for shown in runs
    ]
    rows += [(texts.RUN_NEW, "", programme.title) for programme in PROGRAMMES]
    return Table((texts.COL_RUN, texts.COL_DONE_STEPS, texts.COL_PROGRAMME), tuple(rows))


def run_details(runs: Sequence[RunShown], row: int) -> tuple[Block, ...]:
    """What a programme follows, and its steps by parts."""
    begun = row < len(runs)
    programme = runs[row].programme if begun else PROGRAMMES[row - len(runs)]
    values = {"standard": programme.standard}
    if begun:
        run = runs[row].run
        values["begun"] = f"{run.entries[0].time:%Y-%m-%d %H:%M}"
        values["file"] = run.path
        values["log"] = run.log or ""
    facts = tuple((texts.RUN_FACTS[name], value) for name, value in values.items() if value)
    parts = tuple((str(count), part) for part, count in parts_of(programme).items())
    return (KeyValues(facts), Table(("", ""), parts, "rl"))


def parts_of(programme: Programme) -> dict[str, int]:
    """Groups of steps with how many each has, in their order."""
    found: dict[str, int] = {}
    for step in programme.steps:
        found[step.part] = found.get(step.part, 0) + 1
    return found


def step_line(state: StepState) -> str:
    """One step in the list."""
    told = f"  {state.told}" if state.told else ""
    return f"{texts.PROGRAMME_MARKS[state.status]} {state.step.title}{told}"


def prompt_of(state: ProgrammeState, step: ProgrammeStep) -> str:
    """What Enter does in a step."""
    if step.kind == "read":
        return texts.PROGRAMME_READ.format(asks=" ".join(step.asks))
    if step.kind == "record":
        return texts.PROGRAMME_FROM_LOG if state.run.log else texts.PROGRAMME_NO_LOG
    if step.kind == "wait" and state.waits_min:
        return texts.PROGRAMME_WAIT.format(left=state.waits_min)
    return texts.PROGRAMME_DONE_WITH


def guide_text(state: ProgrammeState, step: ProgrammeStep | None, *, width: int) -> Text:
    """What to do now, and what the readings so far determine."""
    text = Text()
    if state.complete:
        north = state.programme.ends_in == "north"
        text.append(
            f"{texts.PROGRAMME_ALL_NORTH if north else texts.PROGRAMME_ALL}\n", style="bold"
        )
    elif step is not None:
        head = texts.PROGRAMME_NEXT.format(part=step.part, title=step.title)
        _filled(text, head, width, style="bold")
        if step.told:
            _filled(text, step.told, width)
        _filled(text, prompt_of(state, step), width, style="italic")
    if state.programme.needs:
        text.append("\n")
        _filled(text, texts.PROGRAMME_NEEDS.format(needs=state.programme.needs), width)
    known = state.known
    text.append("\n")
    text.append(texts.PROGRAMME_RANK.format(rank=known.rank, of=known.of) + "\n")
    unknown = _names(known.undetermined) if known.undetermined else texts.PROGRAMME_EVERYTHING
    _titled(text, texts.PROGRAMME_UNKNOWN, unknown, width)
    determined = _names(known.determined) if known.determined else texts.PROGRAMME_NOTHING
    _titled(text, texts.PROGRAMME_KNOWN, determined, width)
    text.append(f"{texts.COL_RUN} {state.run.id}\n", style="dim")
    if state.warnings:
        _titled(text, texts.PROGRAMME_TOLD, "; ".join(state.warnings), width)
    return text


def _names(names: Sequence[str]) -> str:
    shown = ", ".join(translated(named(name)) for name in names[:MOST_NAMES])
    if len(names) <= MOST_NAMES:
        return shown
    return f"{shown} {texts.PROGRAMME_MORE.format(count=len(names) - MOST_NAMES)}"


def _titled(text: Text, title: str, words: str, width: int) -> None:
    text.append(f"{title}\n", style="bold")
    _filled(text, words, width, indent="  ")


def _filled(text: Text, words: str, width: int, *, style: str = "", indent: str = "") -> None:
    lines = filled(words, max(width, 20) - len(indent)).split("\n")
    text.append("".join(f"{indent}{line}\n" for line in lines), style=style)
