"""``surveyapp programme``: a guided programme step by step, from the first mount to the card."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Final

from surveyapp.cli.north import print_north
from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.cli.sensor_options import print_calibration, progress_bar
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said

if TYPE_CHECKING:
    from surveyapp.domain.programme import ProgrammeResult, ProgrammeState
    from surveyapp.observation.sensors.programmes import ProgrammeDesk

NEXT: Final = "next"
"""Stands for the step that is next."""

SHOWN: Final = 6
"""Steps after the next one that are shown; ``--json`` has them all."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "action",
        nargs="?",
        default="list",
        metavar="ACTION",
        help="list [PROGRAMME] | runs DIR | start DIR PROGRAMME | show DIR RUN | "
        "enter DIR RUN STEP|next [VALUE ...] | log DIR RUN FILE [map.C=COLUMN unit.C=U ...] | "
        "strike DIR RUN | finish DIR RUN [OPTION=VALUE ...]",
    )
    parser.add_argument("words", nargs="*", metavar="WORD", help="what the action needs")
    parser.add_argument("--id", metavar="RUN", help="id of the run that is started")
    parser.add_argument("--note", default="", metavar="TEXT", help="a remark for the entry")
    parser.add_argument("--card", metavar="OUT.toml", help="where finish writes the sensor card")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Do one action and print where the run stands; 1 where finish determines nothing."""
    found = ACTIONS.get(options.action)
    if found is None:
        hint = nearest_names(options.action, ACTIONS)
        raise SurveyError(
            Problem("there is no such action", "surveyapp programme", options.action, hint=hint)
        )
    least, most, act = found
    count = len(options.words)
    if count < least or (most is not None and count > most):
        expected = f"{least}" if most == least else f"{least} or more"
        raise SurveyError(
            Problem(
                said("{action} needs other words", action=options.action),
                "surveyapp programme",
                f"{count}: {' '.join(options.words)}",
                said("{expected} words; see surveyapp programme --help", expected=expected),
            )
        )
    return act(options)


def _list(options: argparse.Namespace) -> int:
    from surveyapp import api
    from surveyapp.core.sensors.programmes.state import programme_of

    if options.words:
        programme = programme_of(options.words[0])
        if options.json:
            print_json({"schema": "surveyapp.programmes/1", "programmes": [programme.to_dict()]})
            return 0
        print(heading(f"{programme.id}: {programme.title}"))
        print(paragraph(f"follows {programme.standard}"))
        print(table(["step", "what"], [[s.id, s.title] for s in programme.steps]))
        return 0
    every = api.programmes()
    if options.json:
        print_json(every.to_dict())
    else:
        rows = [[p.id, p.kind, str(len(p.steps)), p.standard] for p in every]
        print(table(["programme", "sensor", "steps", "follows"], rows))
    return 0


def _runs(options: argparse.Namespace) -> int:
    from surveyapp.observation.sensors.programmes import runs_of

    shown, problems = runs_of(options.words[0])
    if options.json:
        rows = [
            {"id": s.run.id, "programme": s.programme.id, "done": s.done, "of": s.of} for s in shown
        ]
        print_json({"schema": "surveyapp.programme_runs/1", "runs": rows})
    else:
        print(
            table(
                ["run", "programme", "done"],
                [[s.run.id, s.programme.id, f"{s.done} of {s.of}"] for s in shown],
            )
        )
    if problems:
        raise SurveyError(list(problems))
    return 0


def _start(options: argparse.Namespace) -> int:
    from surveyapp import api
    from surveyapp.observation.sensors.programmes import free_id

    folder, programme = options.words
    identity = options.id or free_id(folder, programme)
    return _tell(options, api.begin_programme(folder, programme, identity))


def _show(options: argparse.Namespace) -> int:
    return _tell(options, _desk(options).look())


def _enter(options: argparse.Namespace) -> int:
    desk = _desk(options)
    step, value = options.words[2], " ".join(options.words[3:])
    if step == NEXT:
        here = desk.state.here
        if here is None:
            where = said("run {identity}", identity=desk.identity)
            raise SurveyError(Problem("every step is done", where, "", "", "finish ends the run"))
        step = here.id
    from surveyapp import api

    api.record_programme(desk.folder, desk.identity, step, value, note=options.note)
    return _tell(options, desk.look())


def _log(options: argparse.Namespace) -> int:
    desk = _desk(options)
    return _tell(options, desk.record("log", f"log={' '.join(options.words[2:])}"))


def _strike(options: argparse.Namespace) -> int:
    return _tell(options, _desk(options).undo(options.note))


def _finish(options: argparse.Namespace) -> int:
    from surveyapp import api
    from surveyapp.observation.sensors.options import told_options

    desk = _desk(options)
    told = told_options(desk.programme.ends_in, " ".join(options.words[2:]))
    result = api.finish_programme(
        desk.folder,
        desk.identity,
        options=told.own,
        log=told_options("add", desk.log_options()).log,
        card=options.card,
        progress=progress_bar(),
    )
    if options.json:
        print_json(result.to_dict())
    else:
        _print_result(result)
    made = result.calibration if result.north is None else result.north
    return 0 if made is not None and made.met else 1


def _desk(options: argparse.Namespace) -> ProgrammeDesk:
    from surveyapp.observation.sensors.programmes import ProgrammeDesk

    folder, identity = options.words[:2]
    return ProgrammeDesk(folder, identity, now=lambda: datetime.now(UTC).astimezone())


def _tell(options: argparse.Namespace, state: ProgrammeState) -> int:
    if options.json:
        print_json(state.to_dict())
        return 0
    programme, here = state.programme, state.here
    print(heading(f"{state.run.id}: {programme.title}"))
    print(paragraph(f"follows {programme.standard}"))
    done = sum(s.status in ("done", "short") for s in state.steps)
    print(f"\n  {done} of {len(state.steps)} steps")
    if here is None:
        print(paragraph("every step is done: finish ends the run"))
    else:
        print(paragraph(f"next  {here.id}: {here.title}. {here.told}"))
        if here.asks:
            print(paragraph(f"reads {' '.join(here.asks)}"))
        if state.waits_min:
            print(paragraph(f"wait  {state.waits_min:.1f} min more"))
        _print_later(state, here.id)
    for warning in state.warnings:
        print(paragraph(f"told in the record: {warning}"))
    if state.known.undetermined:
        print(paragraph(f"still undetermined: {', '.join(state.known.undetermined)}"))
    return 0


def _print_later(state: ProgrammeState, here: str) -> None:
    names = [s.step.id for s in state.steps if s.status == "open" and s.step.id != here]
    if names:
        more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
        print(paragraph(f"then  {', '.join(names[:SHOWN])}{more}"))


def _print_result(result: ProgrammeResult) -> None:
    for warning in result.state.warnings:
        print(paragraph(f"told in the record: {warning}"))
    if result.calibration is not None:
        print_calibration(result.calibration)
    if result.north is not None:
        print_north(result.north)
    if result.card is not None:
        print(f"\ncard written: {result.card}")


Action = Callable[[argparse.Namespace], int]
ACTIONS: Final[dict[str, tuple[int, int | None, Action]]] = {
    "list": (0, 1, _list),
    "runs": (1, 1, _runs),
    "start": (2, 2, _start),
    "show": (2, 2, _show),
    "enter": (3, None, _enter),
    "log": (3, None, _log),
    "strike": (2, 2, _strike),
    "finish": (2, None, _finish),
}
"""Action to the least and most words that it takes, and what does it."""
