"""``surveyapp diagnose``: find the residual, name the effect, prove it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from surveyapp.cli.output import WIDTH, heading, number, paragraph, print_json, table
from surveyapp.languages import said, said_each, shown, term
from surveyapp.languages.names import by_id

if TYPE_CHECKING:
    from surveyapp.workflows.diagnosing import Diagnosed
    from surveyapp.workflows.pooling import InstrumentDiagnosis


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("--session", metavar="ID", help="the turning points of this session")
    parser.add_argument("--campaign", metavar="INSTRUMENT", help="its repeated determinations")
    parser.add_argument("--traverse", metavar="NAME", help="the conditions of this traverse")
    parser.add_argument(
        "--instrument", metavar="ID", help="all its runs and campaigns together, pooled"
    )
    parser.add_argument(
        "--archive",
        metavar="DIR",
        nargs="+",
        default=(),
        help="with --instrument: further projects, or folders of projects, of the same instrument",
    )
    parser.add_argument(
        "--priors",
        metavar="FILE.toml",
        help="with --instrument: write what the campaigns teach, for [[instrument]] priors",
    )
    parser.add_argument("--sensor", metavar="ID", help="this [[sensor_log]]: compass, tilt or rate")
    parser.add_argument(
        "--allow-outside", action="store_true", help="read a log outside the project folder"
    )
    parser.add_argument(
        "--confirm",
        metavar="ID",
        help="a second session, traverse or sensor log that chose nothing; for a campaign, from "
        "which session on determinations only confirm",
    )
    parser.add_argument("--effects", metavar="FILE.py", help="your own effects")
    parser.add_argument(
        "--save-shape",
        metavar="FILE.py",
        help="write a course of north that has no name as an effect for --effects",
    )
    parser.add_argument("--adopt", action="store_true", help="write named effects to the project")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Diagnose and print; 0 with any verdict reached."""
    from surveyapp import api
    from surveyapp.report.sections import diagnosis as section
    from surveyapp.report.text import blocks_text

    if options.instrument is not None:
        return _instrument(options)
    _refuse_archive(options)
    if options.sensor is not None:
        return _sensor(options)
    project = api.open_project(options.folder)
    found = api.diagnose(
        project,
        session=options.session,
        campaign=options.campaign,
        traverse=options.traverse,
        confirm=options.confirm,
        effects=options.effects,
        adopt=options.adopt,
        save_shape=options.save_shape,
    )
    if options.json:
        print_json(found.to_dict())
    elif found.diagnosis is None:
        print(subjects_text(found))
    else:
        made = section.blocks(found.diagnosis, found.words, {}, unit=project.angle_unit)
        print(blocks_text(made, WIDTH))
        for place in found.written:
            print(shown(said("written: {place}", place=place)))
    return 0


def _instrument(options: argparse.Namespace) -> int:
    """All records of an instrument together."""
    from concurrent.futures import ProcessPoolExecutor
    from contextlib import ExitStack

    from surveyapp import api
    from surveyapp.errors import Problem, SurveyError

    others = ("session", "campaign", "traverse", "confirm", "effects", "save_shape")
    named = [f"--{n.replace('_', '-')}" for n in others if getattr(options, n) is not None]
    named += ["--adopt"] if options.adopt else []
    if named:
        found = said("--instrument and {names}", names=", ".join(named))
        raise SurveyError(Problem("one subject at a time", "diagnose", found, "--instrument alone"))
    with ExitStack() as stack:
        pool = stack.enter_context(ProcessPoolExecutor()) if options.archive else None
        result = api.diagnose_instrument(
            options.folder,
            options.instrument,
            archive=options.archive,
            priors=options.priors,
            executor=pool,
        )
    if options.json:
        print_json(result.to_dict())
    else:
        print(instrument_text(result))
    return 0


def _sensor(options: argparse.Namespace) -> int:
    """Diagnose a sensor log."""
    from surveyapp import api
    from surveyapp.errors import Problem, SurveyError

    others = [options.session, options.campaign, options.traverse]
    if any(other is not None for other in others):
        raise SurveyError(
            Problem(
                "one subject at a time",
                "diagnose --sensor",
                "a session, campaign or traverse beside a sensor",
                "--sensor ID alone",
            )
        )
    kinds = {log.id: log.kind for log in api.open_project(options.folder).sensor_logs}
    if kinds.get(options.sensor) in ("rate", "fog-station"):
        return _rate_sensor(options)
    found = api.diagnose_log(
        options.folder,
        sensor=options.sensor,
        allow_outside=options.allow_outside,
        effects=options.effects,
        confirm=options.confirm,
        adopt=options.adopt,
        keep=True,
    )
    if options.json:
        print_json(found.to_dict())
        return 0
    for sentence in found.words:
        print(paragraph(sentence, indent=0))
    for place in found.written:
        print(shown(said("written: {place}", place=place)))
    return 0


def _rate_sensor(options: argparse.Namespace) -> int:
    """The stops of a rate sensor."""
    from surveyapp import api
    from surveyapp.report.sections import diagnosis as section
    from surveyapp.report.text import blocks_text

    found_sensor = api.diagnose_sensor(
        options.folder,
        options.sensor,
        effects=options.effects,
        confirm=options.confirm,
        adopt=options.adopt,
        allow_outside=options.allow_outside,
    )
    if options.json:
        print_json(found_sensor.to_dict())
    else:
        project = api.open_project(options.folder)
        unit = project.angle_unit
        made = section.blocks(found_sensor.diagnosis, found_sensor.words, {}, unit=unit)
        print(blocks_text(made, WIDTH))
        for place in found_sensor.written:
            print(shown(said("written: {place}", place=place)))
    return 0


def _refuse_archive(options: argparse.Namespace) -> None:
    """An archive and its priors belong to an instrument."""
    from surveyapp.errors import Problem, SurveyError

    named = [f"--{name}" for name in ("archive", "priors") if getattr(options, name)]
    if named:
        raise SurveyError(
            Problem(
                "an archive is pooled for one instrument",
                "diagnose",
                said("{names} without --instrument", names=" and ".join(named)),
                "--instrument ID",
            )
        )


def instrument_text(result: InstrumentDiagnosis) -> str:
    """What all records of an instrument say, in words and tables."""
    verdict = term(result.verdict.replace("_", " "))
    head = said("instrument {name}: {verdict}", name=result.instrument.id, verdict=verdict)
    parts = [heading(head)]
    parts.append("\n".join(paragraph(text, indent=0, hanging=0) for text in result.words()))
    if result.pooled is not None:
        rows = [
            [
                by_id(item.effect),
                number(item.evidence, 2),
                number(item.p, 3),
                "" if item.coefficient is None else f"{item.coefficient:.3g}",
                "" if item.sigma is None else f"{item.sigma:.2g}",
                term(item.unit),
                str(item.sessions),
            ]
            for item in result.pooled.effects
        ]
        columns = said_each("effect", "evidence", "p", "coefficient", "sigma", "unit", "runs")
        parts.append(table(columns, rows, indent=0))
    if result.priors is not None:
        shares = sorted(result.priors.shares.items(), key=lambda item: -item[1])
        rows = [[by_id(unit), f"{share:.3f}"] for unit, share in shares]
        parts.append(table(said_each("prior of", "share"), rows, indent=0))
    return "\n\n".join(parts)


def subjects_text(found: Diagnosed) -> str:
    """What could be diagnosed."""
    if not found.subjects:
        return "\n".join(paragraph(text, indent=0, hanging=0) for text in found.words)
    rows = [
        [f"--{s.keyword}", s.id, "" if s.observations is None else str(s.observations)]
        for s in found.subjects
    ]
    return (
        shown(said("Choose one:"))
        + "\n"
        + table((*said_each("option"), "", *said_each("rows")), rows)
    )
