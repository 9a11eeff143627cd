"""An oscillation of one frequency stands in the output: a motor, a mains hum, a servo loop."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Coefficient, Column, Columns, Effect, GridParameter
from surveyapp_models.effects.rate import DEG_S

SAMPLE = Column("sample_s", "time of each sample, s; stops have none")


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Cosine and sine of the line, shape (n, 2)."""
    phase = 2.0 * np.pi * grid["frequency_hz"] * columns["sample_s"]
    return np.column_stack([np.cos(phase), np.sin(phase)])


def frequencies(columns: Columns) -> Floats:
    """Every whole number of cycles up to half the sampling rate [Hz]."""
    time = columns["sample_s"]
    span = float(np.ptp(time)) * time.size / max(time.size - 1, 1)
    return np.arange(1.0, time.size // 2) / span


EFFECT = Effect(
    id="interference_line",
    title="Interference line",
    subject="rate",
    needs=(SAMPLE,),
    coefficients=(
        Coefficient("cosine", "deg/s", DEG_S, -500.0, 500.0, "amplitude in phase with time 0"),
        Coefficient("sine", "deg/s", DEG_S, -500.0, 500.0, "amplitude a quarter period later"),
    ),
    basis=basis,
    grid=(GridParameter("frequency_hz", "Hz", frequencies, "of the line"),),
    datum="output without the line",
    source="source 000-8: 12.48, 24.96 and 37.44 Hz with the table's motor switched on",
    remedy="Find what runs at this frequency; average over whole periods of it.",
    symptom="the samples swung at one frequency",
    separate_by="the same record with motors and chargers switched off",
)
