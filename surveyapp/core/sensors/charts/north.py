"""Pictures of a north: the bias that was followed with its gate, and the headings of the sets."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from surveyapp.core.sensors.charts.results import TIME, Points
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp.domain.chart import Chart, Picture, Series
from surveyapp.domain.north import NorthResult
from surveyapp.languages import counted, joined, said

MOST_DRIFT_DEG = 180.0
"""A heading that changes by more was not followed: the unit was set up anew."""


def north_charts(result: NorthResult) -> tuple[Picture, ...]:
    """Bias and heading from set to set where they were followed; else none."""
    tracking: Sequence[Mapping[str, Any]] = result.extra.get("tracking") or ()
    if len(tracking) < 2:
        return ()
    return (_bias(tracking), *_headings(tracking))


def _bias(tracking: Sequence[Mapping[str, Any]]) -> Chart:
    """What each set says by itself, what the gate lets through, and the track."""
    known = [item for item in tracking if item["sigma"] is not None]
    track = tuple((float(item["time_s"]), float(item["bias"])) for item in known)
    inside = [item for item in tracking if item["alone"] is not None]
    used, left = (
        tuple((float(i["time_s"]), float(i["alone"])) for i in inside if i["gated"] is gated)
        for gated in (False, True)
    )
    gates = [item for item in inside if item["gate"] is not None]
    series = [Series(said("track"), track)]
    series += _bounds(known, "bias", "sigma")
    series += [
        Series(said("set by itself"), used, "dots"),
        Series(said("left out by the gate"), left, "dots"),
    ]
    series += [
        Series(
            said("gate"), tuple((float(g["time_s"]), g["foretold"] + s * g["gate"]) for g in gates),
            "guide",
        )
        for s in (-1.0, 1.0)
    ]  # fmt: skip
    out = sum(bool(item["gated"]) for item in tracking)
    note = counted("{count} set left out", "{count} sets left out", count=out)
    why = dict.fromkeys(str(item["reason"]) for item in tracking if item["reason"])
    return Chart(
        said("Bias of the index axis from set to set"),
        TIME,
        said("bias [deg/h]"),
        tuple(one for one in series if one.points),
        note=joined(": ", [note, joined("; ", list(why))]) if why else note,
    )


def _headings(tracking: Sequence[Mapping[str, Any]]) -> tuple[Picture, ...]:
    """Headings with their 95 % interval: drawn through north, unless the unit was turned about."""
    axis = tracking[-1]["axis"]
    known = [
        dict(item) for item in tracking if item["heading_deg"] is not None and item["axis"] == axis
    ]
    if len(known) < 2:
        return ()
    whole = np.unwrap([item["heading_deg"] for item in known], period=360.0)
    drifting = float(np.ptp(whole)) < MOST_DRIFT_DEG
    if not drifting:
        whole = np.array([item["heading_deg"] for item in known])
    for item, heading in zip(known, whole.tolist(), strict=True):
        item["heading_deg"] = heading
    points = tuple((float(i["time_s"]), float(i["heading_deg"])) for i in known)
    series = (
        Series(said("heading of the set"), points, "line" if drifting else "dots"),
        *_bounds(known, "heading_deg", "heading_sigma_deg"),
    )
    title = said("Heading from set to set")
    return (Chart(title, TIME, said("heading [deg]"), series),)


def _bounds(items: Sequence[Mapping[str, Any]], value: str, sigma: str) -> list[Series]:
    """Lower and upper ends of the 95 % interval."""

    def ends(sign: float) -> Points:
        return tuple(
            (float(i["time_s"]), float(i[value]) + sign * NORMAL_95 * float(i[sigma]))
            for i in items
            if math.isfinite(float(i[sigma]))
        )

    return [Series("95 %", ends(sign), "bound") for sign in (-1.0, 1.0)]
