"""A measured pendulum as a run: dry friction before viscous and quadratic damping.

The record is 5 s of a free swing (encoder, 1000 Hz); its makers find an amplitude law with dry
friction. The damping break stays about as good from 14 extrema: not separable is the verdict.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from surveyapp.diagnosis import TurningPoints, diagnose
from surveyapp.diagnosis.subjects.reversal_run import reversal_run

SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[2] / "../shared/data"))
RECORD = SHARED / "pendulum_free_swing" / "pendulum_free_swing_data_01.txt"
ENCODER_STEP_DEG = 0.09


def extrema(angle_deg: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[float]:
    """Vertex of a parabola through 31 samples about each extremum [deg], the first left out."""
    crossings = np.flatnonzero(np.diff(np.signbit(angle_deg)))
    found = []
    for begin, end in zip([0, *crossings[:-1] + 1], crossings + 1, strict=True):
        if end - begin < 60:
            continue
        middle = begin + int(np.argmax(np.abs(angle_deg[begin:end])))
        window = slice(max(middle - 15, 0), middle + 16)
        c, b, a = np.polynomial.polynomial.polyfit(
            np.arange(angle_deg[window].size), angle_deg[window], 2
        )
        found.append(float(c - b * b / (4.0 * a)))
    return found[1:]


@pytest.mark.shared_data
@pytest.mark.skipif(not RECORD.exists(), reason="the measured records are not there")
def test_dry_friction_is_preferred_to_viscous_and_quadratic_damping() -> None:
    points = extrema(np.loadtxt(RECORD, skiprows=2))
    assert len(points) == 14
    run = TurningPoints(
        [float(v) for v in np.radians(points)], resolution=float(np.radians(ENCODER_STEP_DEG))
    )
    result = diagnose(reversal_run(run))
    by_effect = {item.effect: item for item in result.candidates}
    dry, drag = by_effect["dry_friction"], by_effect["quadratic_drag"]
    assert dry.p is not None
    assert dry.p < 0.01
    assert dry.delta_bic is not None
    assert drag.delta_bic is not None
    assert dry.delta_bic < drag.delta_bic - 4.0
    first = next(t for t in result.ledger["trials"] if t["depth"] == 1)
    alone = next(s["bic"] for s in first["sets"] if s["effects"] == ["dry_friction"])
    viscous = result.ledger["trials"][0]["sets"]
    assert alone < next(s["bic"] for s in viscous if s["effects"] == []) - 4.0
    assert result.verdict == "not_separable"
    assert {item.effect for item in result.adopted} <= {"dry_friction"}
    assert any("damping_break" in option for option in result.ambiguous[0].any_of)
