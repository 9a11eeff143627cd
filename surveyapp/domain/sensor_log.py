"""A sensor log: columns of numbers under their canonical names, and what was seen while reading.

A log is what a compass, a tilt sensor, a gyro or an accelerometer recorded. Names, units and the
meaning of every column stand in one table here; ``io.sensor_logs`` reads files into it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import compress
from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.domain.columns import PIECE, Room, every_kth, in_memory, let_go, pieces
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said

Array = NDArray[np.float64]

STANDARD_GRAVITY_M_S2: Final = 9.80665
"""Standard acceleration of free fall, 3rd CGPM 1901: what one g is in a log."""

NUMBER_COLUMNS: Final[dict[str, str]] = {
    "time_s": "s",
    **{f"acc_{axis}_m_s2": "m/s2" for axis in "xyz"},
    **{f"gyr_{axis}_rad_s": "rad/s" for axis in "xyz"},
    **{f"mag_{axis}_uT": "uT" for axis in "xyz"},
    "temperature_c": "C",
    "reference_temperature_c": "C",
    **{f"ref_q{axis}": "1" for axis in "wxyz"},
    **{f"ref_p{axis}_m": "m" for axis in "xyz"},
    "heading_deg": "deg",
    "tilt_along_arcsec": "arcsec",
    "tilt_across_arcsec": "arcsec",
    "ref_along_arcsec": "arcsec",
    "ref_across_arcsec": "arcsec",
    "set": "1",
    "angle_deg": "deg",
    "flip": "1",
    "output": "LSB",
    "frequency_hz": "Hz",
    "impedance_ohm": "ohm",
    "table_angle_deg": "deg",
    "table_rate_deg_s": "deg/s",
    "pass": "1",
    "round": "1",
    "index_angle_deg": "deg",
    "vertical_circle_deg": "deg",
    "horizontal_circle_deg": "deg",
    "odometer_m": "m",
    "power_cycle": "1",
    "slope_distance_m": "m",
    "height_of_instrument_m": "m",
    "height_of_target_m": "m",
    "from_height_m": "m",
    "to_height_m": "m",
    "pressure_hpa": "hPa",
    "humidity_percent": "%",
}
"""Canonical columns of numbers and the unit in which they are held."""

TEXT_COLUMNS: Final = ("test", "position", "face", "phase", "from_pillar", "to_pillar")
"""Canonical columns that hold a word in each row."""

SENSOR_COLUMNS: Final = tuple(
    name
    for name in NUMBER_COLUMNS
    if name.startswith(("acc_", "gyr_", "mag_", "tilt_")) or name == "output"
)
"""What a sensor itself put out, as against references, settings and times."""

TRIPLES: Final[dict[str, tuple[str, str, str]]] = {
    "acc": ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2"),
    "gyr": ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s"),
    "mag": ("mag_x_uT", "mag_y_uT", "mag_z_uT"),
    "ref_p": ("ref_px_m", "ref_py_m", "ref_pz_m"),
}
"""The three columns of a vector."""

QUATERNION: Final = ("ref_qw", "ref_qx", "ref_qy", "ref_qz")


@dataclass(frozen=True, slots=True)
class Gap:
    """Time without samples: ``start_s`` is the last sample before it, ``end_s`` the next one."""

    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class SensorLog:
    """One log as read.

    Parameters
    ----------
    id : str
        Name for messages: of the ``[[sensor_log]]`` table or of the file.
    columns : mapping of str to ndarray, shape (n,)
        Canonical name to values in the unit of ``units``; NaN where a cell that is not needed is
        empty. Columns that are no canonical ones stand under the name that they have in the file.
    units : mapping of str to str
    texts : mapping of str to tuple of str
        Columns of words.
    size : int
        Rows.
    rate_hz : float or None
        Stated, else from the mean interval of ``time_s`` without its gaps; None where neither is
        there.
    gaps : tuple of Gap
        Intervals of more than 2.5 median ones.
    clipped : mapping of str to int
        Columns that stay at their largest or smallest value, and in how many rows.
    scaled : mapping of str to float
        Columns given in counts, and the stated factor.
    sha256 : str
        Of the file.
    path : str
        For messages.
    first_line : int
        Line of the file with its first row, for messages; 0 where it is no file.
    whole_span_c : tuple of float or None
        Lowest and highest temperature of the record that was thinned to this one.
    warnings : tuple of ResultWarning
    """

    id: str
    columns: Mapping[str, Array]
    units: Mapping[str, str]
    size: int
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    rate_hz: float | None = None
    gaps: tuple[Gap, ...] = ()
    clipped: Mapping[str, int] = field(default_factory=dict)
    scaled: Mapping[str, float] = field(default_factory=dict)
    sha256: str = ""
    path: str = ""
    first_line: int = 0
    whole_span_c: tuple[float, float] | None = None
    warnings: tuple[ResultWarning, ...] = ()

    def __post_init__(self) -> None:
        for name, values in self.columns.items():
            if values.shape != (self.size,):
                raise ValueError(f"column {name} has shape {values.shape}, not ({self.size},)")

    def rows(self, part: slice) -> SensorLog:
        """Some of its rows, evenly spaced; views, nothing is copied."""
        columns = {name: values[part] for name, values in self.columns.items()}
        texts = {name: words[part] for name, words in self.texts.items()}
        size = len(range(*part.indices(self.size)))
        rate = None if self.rate_hz is None else self.rate_hz / (part.step or 1)
        return replace(self, columns=columns, texts=texts, size=size, rate_hz=rate)

    def pieces(self, size: int = PIECE) -> Iterator[SensorLog]:
        """The log in parts of so many rows; what was mapped is let go of after each."""
        for start in range(0, self.size, size):
            yield self.rows(slice(start, start + size))
            for values in self.columns.values():
                let_go(values)

    def every(self, step: int) -> SensorLog:
        """Every k-th row from the first on; copies where the columns are mapped."""
        columns = {name: every_kth(values, step) for name, values in self.columns.items()}
        return replace(self.rows(slice(None, None, step)), columns=columns)

    def chosen(
        self, kept: NDArray[np.bool_], *, most: int | None = None, room: Room = in_memory
    ) -> SensorLog:
        """The rows of a mask, shape (n,); its rate and its gaps stay as they were read.

        ``most`` thins them as ``thinned`` does; ``room`` is where the columns lie.
        """
        size = int(np.count_nonzero(kept))
        every = 1 if most is None else max(-(-size // most), 1)
        columns = {}
        for name, values in self.columns.items():
            columns[name] = room(-(-size // every))
            filled = 0
            for piece, places in zip(pieces(values), kept_places(kept, every), strict=True):
                columns[name][filled : filled + places.size] = piece[places]
                filled += places.size
                let_go(columns[name])
        texts = {name: tuple(compress(words, kept))[::every] for name, words in self.texts.items()}
        found = replace(self, columns=columns, texts=texts, size=-(-size // every))
        return found if every == 1 else found._told_thinned(self, size, every)

    def thinned(self, most: int) -> SensorLog:
        """Every k-th row, so that at most so many are left; a warning tells it."""
        every = -(-self.size // most)
        if every <= 1:
            return self
        rate = self.rate_hz
        return replace(self.every(every), rate_hz=rate)._told_thinned(self, self.size, every)

    def _told_thinned(self, whole: SensorLog, size: int, every: int) -> SensorLog:
        text = said("{size} rows: one in {every} is used", size=size, every=every)
        warnings = (*self.warnings, ResultWarning("thinned", text))
        rate = None if self.rate_hz is None else self.rate_hz / every
        span = whole.temperature_span_c()
        return replace(self, warnings=warnings, rate_hz=rate, whole_span_c=span)

    def temperature_span_c(self) -> tuple[float, float] | None:
        """Lowest and highest temperature of the whole record; None where it holds none."""
        if self.whole_span_c is not None or "temperature_c" not in self.columns:
            return self.whole_span_c
        low, high = np.inf, -np.inf
        for piece in pieces(self.columns["temperature_c"]):
            known = piece[np.isfinite(piece)]
            low = min(low, float(known.min(initial=low)))
            high = max(high, float(known.max(initial=high)))
        return (low, high) if low <= high else None

    def has(self, *names: str) -> bool:
        """Whether every one of these columns is there."""
        return all(name in self.columns or name in self.texts for name in names)

    def vector(self, name: str) -> Array | None:
        """The vector ``acc``, ``gyr``, ``mag`` or ``ref_p``, shape (n, 3); None if incomplete."""
        names = TRIPLES[name]
        return np.column_stack([self.columns[c] for c in names]) if self.has(*names) else None

    def quaternion(self) -> Array | None:
        """Reference attitude, w first, body to a level frame, shape (n, 4); None if incomplete."""
        if not self.has(*QUATERNION):
            return None
        return np.column_stack([self.columns[c] for c in QUATERNION])


def kept_places(kept: NDArray[np.bool_], every: int) -> Iterator[NDArray[np.intp]]:
    """Places of every k-th true value of a mask, shape (n,), in each of its pieces."""
    before = 0
    for start in range(0, kept.size, PIECE):
        here = np.flatnonzero(kept[start : start + PIECE])
        yield here[-before % every :: every]
        before += here.size
