"""The measured sensor logs of the samples, re-exported by ``surveyapp.api``: before and after."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from surveyapp.api.project import open_project
from surveyapp.api.sensor_diagnosis import diagnose_log, diagnose_sensor
from surveyapp.api.sensors import allan, calibrate
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.demonstrated import BeforeAfter, DemonstratedSensor
from surveyapp.domain.records import Listing
from surveyapp.domain.sensor_entry import SensorLogEntry


def demo_sensors() -> Listing[DemonstratedSensor]:
    """Every sensor log of the samples: what calibration and diagnosis make of it."""
    from surveyapp.io.locations import sample_names, samples_folder

    found = []
    for name in sample_names():
        folder = samples_folder() / name
        if not (folder / "sensors").is_dir():
            continue
        project = open_project(folder)
        found += [_shown(folder, project.name, entry) for entry in project.sensor_logs]
    return Listing("surveyapp.demo_sensors/1", "sensors", tuple(found))


def _shown(folder: Path, title: str, entry: SensorLogEntry) -> DemonstratedSensor:
    makers = {"compass": _compass, "rate": _rate}
    numbers, named, words = makers.get(entry.kind or "", _noise)(folder, entry)
    return DemonstratedSensor(folder.name, title, str(folder), numbers, named, words)


Shown = tuple[tuple[BeforeAfter, ...], str, tuple[str, ...]]


def _compass(folder: Path, entry: SensorLogEntry) -> Shown:
    document = diagnose_log(folder, sensor=entry.id).to_dict()
    held, unit = document["held_out"], document["unit"]
    before, after = document["before"]["rms"], document["after"]["rms"]
    numbers = (
        BeforeAfter("size of the field about a constant, rms", before, after, unit),
        BeforeAfter("the same on blocks left out", held["before"], held["after"], unit),
    )
    return numbers, _named(document), _coefficients(document, ("on_s", "off_s"))


def _coefficients(document: dict[str, Any], names: tuple[str, ...]) -> tuple[str, ...]:
    shown = [
        f"{c['name']} {c['value']:.1f} {c['unit']}"
        for item in document["adopted"]
        for c in item["coefficients"]
        if c["name"] in names and c["value"] is not None
    ]
    return (", ".join(shown),) if shown else ()


def _rate(folder: Path, entry: SensorLogEntry) -> Shown:
    result = calibrate("rate", folder, sensor=entry.id)
    document = diagnose_sensor(folder, entry.id, log=False).to_dict()
    unit = document["unit"]
    left = [document[key]["loo_rms"] for key in ("before", "after")]
    numbers = (
        *_models(result),
        BeforeAfter("gyro at the stops, each left out", left[0], left[1], unit),
    )
    return numbers, _named(document), ()


def _models(result: Calibration) -> tuple[BeforeAfter, ...]:
    """Size of gravity by the simplest and by the chosen model of the accelerometers."""
    first = result.models[0]
    chosen = next((model for model in result.models if model.chosen), first)
    name = "size of gravity at the stops, rms"
    unit = result.after.unit
    return (
        BeforeAfter(name, first.rms, chosen.rms, unit),
        BeforeAfter("the same at stops left out", first.held_out_rms, chosen.held_out_rms, unit),
    )


def _noise(folder: Path, entry: SensorLogEntry) -> Shown:
    """Means of one sample against the longest that still gain."""
    (channel, *_) = allan(folder, sensor=entry.id).channels
    best = min(range(len(channel.deviation)), key=lambda k: channel.deviation[k])
    name = f"Allan deviation, {channel.taus_s[0]:g} s and {channel.taus_s[best]:g} s"
    number = BeforeAfter(name, channel.deviation[0], channel.deviation[best], channel.unit)
    known = [c for c in channel.coefficients if c.value is not None]
    words = tuple(
        f"{c.name.replace('_', ' ')} {c.value:.3g} +-{c.sigma:.2g} {c.unit}"
        for c in known
        if c.sigma is not None
    )
    return (number,), "", words


def _named(document: dict[str, Any]) -> str:
    return ", ".join(str(item["effect"]) for item in document["adopted"])
