"""Sensor cards as files: one TOML file holds the calibration of one sensor.

A card is read strictly, all problems together, and written as a whole. It never replaces a file
that is no sensor card.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final, cast

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.sensors.card_names import CONSTANTS, PARAMETERS
from surveyapp.core.sensors.rate.card_temperature import MODEL_KEYS, model_of
from surveyapp.core.sensors.rate.card_temperature import TABLE as MODEL_TABLE
from surveyapp.core.sensors.rate.compensation import MODELS
from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.sensor_entry import SENSOR_KINDS, SensorKind
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.cards import number_pair
from surveyapp.io.files import read_text, shown_path
from surveyapp.io.findings import Findings
from surveyapp.io.tables import Table, as_number, parse_toml
from surveyapp.io.tomltext import atomic_write, toml_key, toml_value
from surveyapp.languages import joined, said

_ASYMMETRY: Final = 1e-9


def read_sensor_card(path: Path, *, where: str | None = None) -> SensorCard:
    """Read a sensor card.

    Raises
    ------
    SurveyError
        With all problems of the file.
    """
    place = where or path.name
    findings = Findings()
    table = Table(parse_toml(read_text(path, where=place), where=place), place, findings)
    card = _card(table)
    findings.raise_if_any()
    return replace(card, warnings=findings.told())


def _card(table: Table) -> SensorCard:
    table.get("format")
    parameters = _parameters(table)
    pair = None
    temperature = table.get("temperature_c")
    if temperature is not None:
        pair = number_pair(temperature)
        if pair is None:
            table.problem("temperature_c is no range", temperature, "[lowest, highest]")
    valid_from, valid_to = table.date("valid_from"), table.date("valid_to")
    if valid_from is not None and valid_to is not None and valid_to < valid_from:
        table.problem("valid_to lies before valid_from", valid_to.isoformat())
    known = sum(item.sigma is not None for item in parameters)
    kind = cast("SensorKind", table.choice("kind", SENSOR_KINDS, required=True) or "rate")
    _check_names(table, "parameter", PARAMETERS.get(kind))
    _check_names(table, "constants", CONSTANTS.get(kind))
    card = SensorCard(
        id=table.text("id", required=True) or "",
        title=table.text("title", required=True) or "",
        kind=kind,
        source=table.text("source", required=True, multiline=True) or "",
        parameters=parameters,
        calibrated_on=table.date("calibrated_on"),
        valid_from=valid_from,
        valid_to=valid_to,
        temperature_c=pair,
        sha256=table.text("sha256") or "",
        covariance=_covariance(table, known),
        constants=_constants(table),
        notes=_notes(table),
    )
    extra = {key: table.data[key] for key in table.unread()}
    _check_temperature_model(table)
    table.warn_unknown("instrument", "serial")
    return replace(card, extra=extra)


def _check_names(table: Table, key: str, known: Collection[str] | None) -> None:
    """Tell names that no calibration writes and no correction reads."""
    inner = table.table(key)
    if inner is None or known is None:
        return
    for name in inner.data:
        if name not in known:
            table.findings.unknown_key(name, where=inner.where, known=known)


def _check_temperature_model(table: Table) -> None:
    """Refuse a temperature model that is not whole: without it the biases would be nominal."""
    inner = table.table(MODEL_TABLE)
    if inner is None:
        return
    inner.choice("model", MODELS, required=True)
    for key in MODEL_KEYS:
        inner.get(key)
    inner.warn_unknown()
    if model_of(table.data) is None:
        inner.problem(
            "the temperature model is not whole",
            joined(", ", inner.data),
            "a model, its nodes, and a bias of every axis at each of them",
        )


def _parameters(table: Table) -> tuple[SensorParameter, ...]:
    inner = table.table("parameter")
    if inner is None:
        table.problem("the card has no parameter", "", "[parameter.NAME] value, sigma, unit")
        return ()
    found = []
    for name in inner.data:
        item = inner.table(name)
        if item is None:
            continue
        value = item.number("value", required=True)
        sigma = item.number("sigma", low=0.0)
        found.append(SensorParameter(name, value, sigma, item.text("unit", required=True) or ""))
        item.warn_unknown()
    return tuple(found)


def _covariance(table: Table, size: int) -> NDArray[np.float64] | None:
    value = table.get("covariance")
    if value is None:
        return None
    rows = value if isinstance(value, list) else []
    numbers = [[as_number(v) for v in row] if isinstance(row, list) else [] for row in rows]
    if len(numbers) != size or any(len(r) != size or None in r for r in numbers):
        expected = said("{size} rows of {size} numbers, for the parameters with a sigma", size=size)
        table.problem("covariance has another size", f"{len(numbers)} rows", expected)
        return None
    matrix = np.array(numbers, dtype=np.float64).reshape(size, size)
    scale = float(np.abs(matrix).max()) if size else 0.0
    if np.abs(matrix - matrix.T).max(initial=0.0) > _ASYMMETRY * scale:
        table.problem("covariance is not symmetric", "", "a symmetric matrix")
        return None
    return matrix


def _constants(table: Table) -> dict[str, float]:
    inner = table.table("constants")
    if inner is None:
        return {}
    return {k: v for k in inner.data if (v := inner.number(k)) is not None}


def _notes(table: Table) -> dict[str, str]:
    inner = table.table("notes")
    if inner is None:
        return {}
    return {k: v for k in inner.data if (v := inner.text(k, multiline=True)) is not None}


def write_sensor_card(path: Path, card: SensorCard) -> None:
    """Write a card as a whole.

    Raises
    ------
    SurveyError
        If another kind of file stands there, or the system refuses.
    """
    if path.exists():
        try:
            read_sensor_card(path)
        except SurveyError:
            raise SurveyError(
                Problem(
                    "a file that is no sensor card stands there",
                    "card",
                    shown_path(path),
                    "a name of its own for the card",
                )
            ) from None
    atomic_write(path, card_text(card).encode("utf-8"))


def card_text(card: SensorCard) -> str:
    """The card as TOML."""
    top: dict[str, object] = {
        "id": card.id,
        "title": card.title,
        "kind": card.kind,
        "source": card.source,
        "calibrated_on": card.calibrated_on,
        "valid_from": card.valid_from,
        "valid_to": card.valid_to,
        "temperature_c": None if card.temperature_c is None else list(card.temperature_c),
        "sha256": card.sha256 or None,
        "covariance": None if card.covariance is None else card.covariance.tolist(),
    }
    top |= {k: v for k, v in card.extra.items() if not isinstance(v, Mapping)}
    lines = _lines(top)
    for item in card.parameters:
        if item.value is None:
            continue
        lines += ["", f"[parameter.{toml_key(item.name)}]"]
        lines += _lines({"value": item.value, "sigma": item.sigma, "unit": item.unit})
    tables: dict[str, object] = {"constants": card.constants, "notes": card.notes}
    tables |= {k: v for k, v in card.extra.items() if isinstance(v, Mapping)}
    for name, mapping in tables.items():
        if mapping:
            lines += ["", f"[{toml_key(name)}]", *_lines(cast("Mapping[str, object]", mapping))]
    return "\n".join(lines) + "\n"


def _lines(mapping: Mapping[str, object]) -> list[str]:
    return [f"{toml_key(k)} = {toml_value(v)}" for k, v in mapping.items() if v is not None]
