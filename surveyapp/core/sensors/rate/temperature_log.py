"""``calibrate rate --programme temperature``: a unit on a table in a chamber, node by node.

At each temperature three positions, turned both ways. The gyros are determined completely (the
vertical earth rate needs the latitude); one position per direction leaves the accelerometers three
equations an axis for four unknowns, so their misalignments must come from a room-temperature log.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from surveyapp.core.sensors.rate.accelerometers import (
    AccelerometerTriad,
    solve_accelerometers,
)
from surveyapp.core.sensors.rate.card_temperature import TABLE, TemperatureModel
from surveyapp.core.sensors.rate.compensation import (
    Compensation,
    ModelName,
    chosen_model,
    compare_models,
)
from surveyapp.core.sensors.rate.gross_samples import gross_samples
from surveyapp.core.sensors.rate.parameters import (
    condition_of,
)
from surveyapp.core.sensors.rate.position_log import (
    ACCELEROMETERS,
    GYROS,
    label_problems,
    means_of,
    place_problems,
    placed_stretches,
    resting_of,
    sense_of,
    unit_problems,
)
from surveyapp.core.sensors.rate.table_log import encoder_told, motion_of, sense_warnings
from surveyapp.core.sensors.rate.temperature_nodes import (
    FULL_RANK,
    Node,
    TemperatureOptions,
    nodes_of,
    predicted,
    series_of,
)
from surveyapp.domain.calibration import (
    Calibration,
    CalibrationModel,
    Geometry,
    HeldOut,
    Misfit,
)
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp.languages.names import by_id
from surveyapp_models.arrays import Floats

CHAMBER = "reference_temperature_c"
NODE_GAP_C = 1.5
"""Chamber temperatures closer than this are one node."""
REFERENCE_C = 20.0
"""Temperature at which the parameters of the card stand, where the nodes hold it."""


def node_numbers(temperatures: Floats) -> tuple[Floats, list[int]]:
    """Nodes of the chamber, sorted, and the number of the node of each row (from 0)."""
    order = np.sort(np.unique(np.round(temperatures, 3)))
    cuts = np.flatnonzero(np.diff(order) > NODE_GAP_C)
    groups = np.split(order, cuts + 1)
    centres = np.array([float(np.mean(g)) for g in groups])
    number = np.argmin(np.abs(temperatures[:, None] - centres[None, :]), axis=1)
    levels = [float(np.mean(temperatures[number == k])) for k in range(centres.size)]
    return np.array(levels), number.tolist()


def calibrate_temperature(log: SensorLog, options: TemperatureOptions) -> Calibration:
    """Parameters at each node, how to go between them, and how well that serves.

    Raises
    ------
    SurveyError
        With everything that cannot be used.
    """
    problems = place_problems(log)
    motion = motion_of(log)
    if isinstance(motion, Problem):
        raise SurveyError([*problems, motion])
    levels, numbers = node_numbers(log.columns[CHAMBER])
    log = replace(log, columns={**log.columns, CHAMBER: levels[numbers]})
    problems += _outside(levels, options.predict_at, log.path)
    if problems:
        raise SurveyError(problems)
    placed, problems = placed_stretches(log, motion, numbers, ("position", CHAMBER))
    _, resting = resting_of(log, motion, placed, levelled=True)
    shown = means_of(log, placed, latitude=options.latitude)
    means, warnings, wrong = sense_of(shown, where=log.path)
    noted, told = encoder_told(
        log,
        motion,
        [t for p in placed for t in p.turned],
        relative_rate_sigma=options.relative_rate_sigma,
    )
    problems += [*wrong, *told]
    problems += label_problems(resting, where=log.path)
    problems += [] if problems else unit_problems(shown, where=log.path)
    if problems:
        raise SurveyError(problems)
    room = None
    if options.room is not None:
        room = solve_accelerometers(options.room, gravity=options.gravity)
        problems += _room_problems(room)
        if problems:
            raise SurveyError(problems)
    nodes = nodes_of(levels, means, resting, room, options=options)
    noted += gross_samples(log, [t for p in placed for t in p.turned], GYROS)
    return _calibration(log, nodes, options, [*sense_warnings(motion, warnings), *noted])


def _outside(levels: Floats, wanted: Sequence[float], where: str) -> list[Problem]:
    low, high = float(levels.min()), float(levels.max())
    return [
        Problem(
            "the temperature lies outside the nodes",
            f"{where}, `predict_at`",
            f"{t:g} C",
            said("{low:g} to {high:g} C", low=low, high=high),
            "nothing is extrapolated: calibrate over the range in which the unit is used",
        )
        for t in wanted
        if not low <= t <= high
    ]


def _room_problems(room: AccelerometerTriad) -> list[Problem]:
    if room.rank == FULL_RANK:
        return []
    return [
        Problem(
            "the room-temperature log does not determine the accelerometers",
            "room",
            said("rank {rank} of 12", rank=room.rank),
            "six positions, each axis up and down",
        )
    ]


def _calibration(
    log: SensorLog,
    nodes: list[Node],
    options: TemperatureOptions,
    warnings: list[ResultWarning],
) -> Calibration:
    temperatures = np.array([n.temperature_c for n in nodes])
    names = [f"bias_{a}" for a in "xyz"]
    series = [series_of(nodes, name) for name in names]
    known = [s.values for s in series if s is not None]
    comparison: tuple[Compensation, ...] = ()
    if known:
        comparison = compare_models(temperatures, np.column_stack(known))
    model = chosen_model(comparison)
    low, high = float(temperatures.min()), float(temperatures.max())
    at = min(max(REFERENCE_C, low), high)
    parameters = tuple(predicted(nodes, model, at))
    missing = _missing(nodes, log)
    rms = {c.model: c.held_out_rms for c in comparison}
    biases = said("biases at left-out nodes")
    return Calibration(
        kind="temperature",
        source=log.id,
        parameters=parameters,
        before=Misfit(rms.get("none"), "deg/h", said("biases at left-out nodes, no compensation")),
        after=Misfit(
            rms.get(model), "deg/h", said("biases at left-out nodes, {model}", model=by_id(model))
        ),
        geometry=Geometry(
            "good" if not missing else "restricted", condition_of(nodes[0].gyro.matrix), missing
        ),
        held_out=HeldOut(
            said("one inner node after the other"), rms.get("none"), rms.get(model), "deg/h"
        ),
        models=tuple(
            CalibrationModel(c.model, None, c.held_out_rms, c.model == model, "deg/h", biases)
            for c in comparison
        ),
        warnings=(*log.warnings, *warnings, *_warnings(log, comparison, options)),
        met=not missing,
        n=log.size,
        sha256=log.sha256,
        temperature_c=(low, high),
        constants={"reference_temperature_c": at},
        tables=_card_table(log, nodes, model),
        extra=_extra(log, nodes, options, comparison, model=model),
    )


def _card_table(log: SensorLog, nodes: Sequence[Node], model: ModelName) -> dict[str, Any]:
    """The temperature model for the card, over the chamber's and the sensor's own temperature."""
    series = [series_of(nodes, f"bias_{a}") for a in "xyz"]
    known = [s.values for s in series if s is not None]
    if len(known) < len(series):
        return {}
    chamber = np.array([n.temperature_c for n in nodes])
    places = {CHAMBER: chamber}
    own = log.columns.get("temperature_c")
    if own is not None:
        _, numbers = node_numbers(log.columns[CHAMBER])
        rows = np.array(numbers)
        means = np.array([float(np.nanmean(own[rows == k])) for k in range(chamber.size)])
        if np.all(np.isfinite(means)) and np.unique(means).size == means.size:
            places["temperature_c"] = means
    return {TABLE: TemperatureModel(model, places, np.column_stack(known)).to_table()}


def _extra(
    log: SensorLog,
    nodes: Sequence[Node],
    options: TemperatureOptions,
    comparison: Sequence[Compensation],
    *,
    model: ModelName,
) -> dict[str, Any]:
    """The keys that only this programme has."""
    return {
        "nodes": [
            {"temperature_c": n.temperature_c, "parameters": [p.to_dict() for p in n.parameters]}
            for n in nodes
        ],
        "predicted": [
            {
                "temperature_c": t,
                "parameters": [p.to_dict() for p in predicted(nodes, model, t)],
            }
            for t in options.predict_at
        ],
        "chosen": model,
        "compensation": [
            {"model": c.model, "held_out_rms": c.held_out_rms, "admissible": c.admissible}
            for c in comparison
        ],
        "accelerometer_rank": _ranks(log, options),
    }


def _ranks(log: SensorLog, options: TemperatureOptions) -> dict[str, int] | None:
    """Rank of the accelerometer equations of a node: of twelve, of six with the room log."""
    if not log.has(*ACCELEROMETERS):
        return None
    axes = {word[0] for word in log.texts["position"] if word}
    signs = {word for word in log.texts["position"] if word}
    full = all({f"{a}+", f"{a}-"} <= signs for a in "xyz")
    alone = 12 if full else 3 * (len(axes) + (1 if len(signs) > len(axes) else 0))
    if options.room is None:
        return {"rank": alone, "of": 12}
    return {"rank": 6, "of": 6}


def _missing(nodes: Sequence[Node], log: SensorLog) -> tuple[str, ...]:
    names = dict.fromkeys(p.name for n in nodes for p in n.parameters if p.value is None)
    if not log.has(*ACCELEROMETERS):
        names |= dict.fromkeys(
            f"accelerometer_misalignment_{a}{b}" for a in "xyz" for b in "xyz" if a != b
        )
    return tuple(names)


def _warnings(
    log: SensorLog, comparison: Sequence[Compensation], options: TemperatureOptions
) -> list[ResultWarning]:
    warnings = []
    grey = next((c for c in comparison if c.model == "grey"), None)
    if grey is not None:
        text = (
            "the grey model is admissible; that says nothing of its usefulness: only the error at "
            "left-out nodes does"
            if grey.admissible
            else "the grey model is not admissible; that says nothing of its usefulness: only the "
            "error at left-out nodes does"
        )
        warnings.append(ResultWarning("grey_model", text))
    if options.room is None:
        text = (
            "one position per direction: the accelerometer equations have rank 9 of 12; "
            "misalignments are not determined, and bias and scale factor assume that there are "
            "none. --room FILE brings them from six positions at room temperature"
        )
        warnings.append(ResultWarning("accelerometer_rank", text))
    if not log.has(*ACCELEROMETERS):
        text = (
            "no accelerometers: the table's axis was taken for vertical; a lean of .3 degrees puts "
            "up to .08 deg/h into the biases"
        )
        warnings.append(ResultWarning("table_lean_unknown", text))
    else:
        text = said(
            "accelerometer scale factors refer to {gravity:.5f} m/s2; "
            "--gravity-m-s2 states the local one",
            gravity=options.gravity,
        )
        warnings.append(ResultWarning("gravity", text))
    return warnings
