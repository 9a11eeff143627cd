"""The priors file of an instrument: learned from an archive, shown, versioned, handed on.

A TOML file beside the project; ``[[instrument]] priors = "priors.toml"`` uses it. Every share
stands in it by name, so that a person can read what the prediction takes for likely.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Final

from surveyapp.domain.instrument import Instrument
from surveyapp.domain.priors import AMPLITUDES, BASE, UNITS, Priors
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import decode
from surveyapp.io.findings import Findings
from surveyapp.io.outputs import write_output
from surveyapp.io.project_files import ProjectFiles
from surveyapp.io.tables import Table, parse_toml
from surveyapp.io.tomltext import toml_value
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC

FORMAT: Final = 1
KIND: Final = "priors of the instrument constant"
MOST_SCATTER: Final = 3600.0
TOLERANCE: Final = 0.01
"""By which shares written by hand may miss a sum of 1."""


def priors_text(priors: Priors, *, instrument: str, serial: str, software: str) -> str:
    """The file as text."""
    head: dict[str, object] = {
        "format": FORMAT,
        "kind": KIND,
        "instrument": instrument,
        "serial": serial,
        "origin": priors.origin,
        "sessions": priors.sessions,
        "software": software,
    }
    if priors.scatter is not None:
        head["scatter_arcsec"] = round(priors.scatter / ARCSEC, 3)
    lines = [f"{key} = {toml_value(value)}" for key, value in head.items()]
    lines += ["", "[shares]  # of campaigns that each cause explains; sum 1"]
    lines += [f"{unit} = {priors.share(unit):.5f}" for unit in UNITS]
    lines += ["", "[sizes]  # shares of sizes in standard deviations of a determination; sum 1"]
    pairs = zip(AMPLITUDES, priors.sizes, strict=True)
    lines += [f'"{size:g}" = {share:.5f}' for size, share in pairs]
    return "\n".join(lines) + "\n"


def write_priors(path: Path, text: str) -> None:
    """Write the file, whole or not at all."""
    try:
        write_output(path, text.encode("utf-8"), named=False)
    except OSError as error:
        reason = error.strerror or str(error)
        raise SurveyError(
            Problem(
                said("the priors cannot be written ({reason})", reason=reason),
                str(path),
                "",
                "a writable folder",
            )
        ) from error


def parse_priors(data: bytes, where: str, findings: Findings) -> Priors | None:
    """Priors of a file, with what is wrong or odd in the findings; None where it is wrong.

    Raises
    ------
    SurveyError
        If it is no priors file.
    """
    table = Table(parse_toml(decode(data, where=where), where=where), where, findings)
    version, kind = table.get("format"), table.get("kind")
    if version != FORMAT or kind != KIND:
        found = said("format = {value!r}, kind = {value2!r}", value=version, value2=kind)
        expected = said("format = {format}, kind = {kind!r}", format=FORMAT, kind=KIND)
        raise SurveyError(Problem("this is no priors file", where, found, expected))
    for key in ("instrument", "serial", "software"):  # for a reader; nothing computes with them
        table.get(key)
    shares = _shares(table, "shares", UNITS)
    names = tuple(f"{size:g}" for size in AMPLITUDES)
    sizes = _shares(table, "sizes", names)
    if shares and not shares[BASE] > 0.0:
        table.problem("the base model has no share", "0", "above 0")
        return None
    scatter = table.number("scatter_arcsec", low=0.0, high=MOST_SCATTER)
    sessions = table.number("sessions", low=0.0)
    origin = table.text("origin", multiline=True)
    table.warn_unknown()
    if not shares or not sizes:
        return None
    return Priors(
        shares,
        tuple(sizes[name] for name in names),
        origin or where,
        int(sessions or 0),
        None if scatter is None else scatter * ARCSEC,
    )


def _shares(table: Table, key: str, names: tuple[str, ...]) -> dict[str, float]:
    """A table of shares, normalized; what is not named is 0. Empty where it is wrong."""
    inner = table.table(key)
    if inner is None:
        if key not in table:
            table.problem(said("{key} is missing", key=key), "", ", ".join(names))
        return {}
    values = {name: inner.number(name, low=0.0, high=1.0) for name in names if name in inner}
    inner.refuse_unknown(*names)
    found = {name: value for name, value in values.items() if value is not None}
    if len(found) < len(inner.data):
        return {}
    total = math.fsum(found.values())
    if abs(total - 1.0) > TOLERANCE:
        inner.problem("the shares do not sum to 1", f"{total:.3f}", "1")
        return {}
    return {name: found.get(name, 0.0) / total for name in names}


def with_priors(instrument: Instrument, table: Table, files: ProjectFiles) -> Instrument:
    """The instrument with the priors that its table names; problems are noted."""
    name = table.text("priors")
    if name is None:
        return instrument
    where = said("{where}, priors", where=table.where)
    data = files.read(name, where)
    if data is None:
        return instrument
    try:
        return replace(instrument, priors=parse_priors(data, where, files.findings))
    except SurveyError as error:
        files.findings.absorb(error)
        return instrument
