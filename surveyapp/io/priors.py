"""The priors file of an instrument: learned from an archive, shown, versioned, handed on.

A TOML file beside the project; ``[[instrument]] priors = "priors.toml"`` uses it. Every share
stands in it by name, so that a person can read what the prediction takes for likely.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from surveyapp.domain.instrument import Instrument
from surveyapp.domain.priors import AMPLITUDES, BASE, UNITS, Priors
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.outputs import write_output
from surveyapp.io.project_files import ProjectFiles
from surveyapp.io.tables import Table
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


def parse_priors(data: bytes, where: str) -> Priors:
    """Priors of a file.

    Raises
    ------
    SurveyError
        With everything that is wrong with it.
    """
    try:
        raw = tomllib.loads(data.decode("utf-8-sig"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        expected = "a file that diagnose --priors wrote"
        raise SurveyError(Problem("the priors are no TOML", where, str(error), expected)) from error
    problems: list[Problem] = []
    if raw.get("format") != FORMAT or raw.get("kind") != KIND:
        found = said(
            "format = {value!r}, kind = {value2!r}", value=raw.get("format"), value2=raw.get("kind")
        )
        expected = said("format = {format}, kind = {kind!r}", format=FORMAT, kind=KIND)
        raise SurveyError(Problem("this is no priors file", where, found, expected))
    shares = _shares(raw.get("shares"), UNITS, f"{where}, [shares]", problems)
    names = tuple(f"{size:g}" for size in AMPLITUDES)
    sizes = _shares(raw.get("sizes"), names, f"{where}, [sizes]", problems)
    if not problems and not shares[BASE] > 0.0:
        problems.append(Problem("the base model has no share", where, "0", "above 0"))
    scatter = _scatter(raw.get("scatter_arcsec"), where, problems)
    if problems:
        raise SurveyError(problems)
    sessions = raw.get("sessions")
    return Priors(
        shares,
        tuple(sizes[name] for name in names),
        str(raw.get("origin", "")) or where,
        sessions if isinstance(sessions, int) else 0,
        scatter,
    )


def _scatter(raw: Any, where: str, problems: list[Problem]) -> float | None:
    """Scatter of the constant [rad], None where the file does not tell it."""
    if raw is None:
        return None
    number = isinstance(raw, int | float) and not isinstance(raw, bool)
    if not number or not 0.0 <= float(raw) <= MOST_SCATTER:
        expected = said("0 to {most_scatter:g} arc-seconds", most_scatter=MOST_SCATTER)
        problems.append(
            Problem("this is no scatter", f"{where}, scatter_arcsec", str(raw), expected)
        )
        return None
    return float(raw) * ARCSEC


def _shares(
    raw: Any, names: tuple[str, ...], where: str, problems: list[Problem]
) -> dict[str, float]:
    """A table of shares, normalized; what is not named is 0."""
    if not isinstance(raw, dict):
        problems.append(Problem("a table is missing", where, "", ", ".join(names)))
        return {}
    found: dict[str, float] = {}
    for name, value in raw.items():
        if name not in names:
            hint = nearest_names(str(name), names)
            problems.append(Problem("an unknown name", where, str(name), ", ".join(names), hint))
        elif isinstance(value, bool) or not isinstance(value, int | float):
            problems.append(Problem("a share is no number", where, f"{name} = {value!r}", "0 to 1"))
        elif not 0.0 <= float(value) <= 1.0:
            told = f"{name} = {value}"
            problems.append(Problem("a share is out of range", where, told, "0 to 1"))
        else:
            found[name] = float(value)
    total = math.fsum(found.values())
    if not problems and abs(total - 1.0) > TOLERANCE:
        problems.append(Problem("the shares do not sum to 1", where, f"{total:.3f}", "1"))
    return {name: found.get(name, 0.0) / total if total > 0.0 else 0.0 for name in names}


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
        return replace(instrument, priors=parse_priors(data, where))
    except SurveyError as error:
        files.findings.absorb(error)
        return instrument
