"""Every guided programme as a value: a new one is a value here and its design.

Sources: 000 (tilt sensor, compass, IMU over temperature), 001 (gyro on a total station), 002 (north
by rotation), 003 (six positions), Tedaldi, Pretto and Menegatti 2014 (hand-held stops).
"""

from __future__ import annotations

from typing import Final

from surveyapp.core.sensors.rate.rotation import STEP_TITLES
from surveyapp.domain.programme import Programme, ProgrammeStep, Row

TILT_STANDARD: Final = "JJF 1427-2013, as source 000 carries it out"
WARM_UP_MIN: Final = 10.0
GYRO_WARM_UP_MIN: Final = 30.0
RANGES: Final = {1: (90.0, 15.0), 2: (30.0, 5.0), 3: (15.0, 2.5)}
"""Set of the static test: half range and step [degrees], 13 points each (source 000)."""
TRANSVERSE_DEG: Final = tuple(30.0 * k for k in range(7))
ZERO_POINTS: Final = 13
"""Readings of the zero over an hour: one every five minutes."""
SWING_DEG: Final = tuple(30.0 * k for k in range(12))
SIX: Final = ("z+", "z-", "x+", "x-", "y+", "y-")
NODES_C: Final = (-10.0, 5.0, 20.0, 30.0, 40.0)
STOPS: Final = 18
"""Hand-held stops that are advised: naming an effect among nine parameters takes that many."""


def _ready(mount: str, *, minutes: float = WARM_UP_MIN) -> tuple[ProgrammeStep, ...]:
    return (
        ProgrammeStep("mount", "Mount the sensor", mount, part="ready"),
        ProgrammeStep("power", "Power on", "The warm-up counts from this moment.", part="ready"),
        ProgrammeStep(
            "warm-up",
            f"Warm up {minutes:g} min",
            "Leave the sensor alone. Going on earlier is possible and will be told.",
            "wait",
            minutes=minutes,
            since="power",
            part="ready",
        ),
    )


def _reversal(prefix: str = "zero") -> tuple[ProgrammeStep, ...]:
    return tuple(
        ProgrammeStep(
            f"{prefix}-{180 * flip}",
            f"At {180 * flip} degrees",
            "Near the horizontal; turn the sensor by 180 degrees on its base between the two.",
            "read",
            asks=("output",),
            row={"test": "reversal", "flip": float(flip)},
            part="0/180 zero",
        )
        for flip in (0, 1)
    )


def _signed(angle: float) -> str:
    return f"{angle:+g}" if angle else "0"


def _static(*sets: int) -> tuple[ProgrammeStep, ...]:
    found = []
    for number in sets:
        half, step = RANGES[number]
        for k in range(13):
            angle = -half + step * k
            found.append(
                ProgrammeStep(
                    f"static-{number}-{k + 1:02d}",
                    f"{_signed(angle)} of +-{half:g} degrees",
                    f"Set the dividing head to {_signed(angle)} degrees and read the output.",
                    "read",
                    asks=("output",),
                    row={"test": "static", "set": float(number), "angle_deg": angle},
                    part=f"static, +-{half:g} degrees",
                )
            )
    return tuple(found)


def _transverse() -> tuple[ProgrammeStep, ...]:
    return tuple(
        ProgrammeStep(
            f"transverse-{angle:03.0f}-{flip}",
            f"{angle:g} degrees{', turned by 180' if flip else ''}",
            "Turn about the sensitive axis, which is level and along the axis of the head.",
            "read",
            asks=("output",),
            row={"test": "transverse", "angle_deg": angle, "flip": float(flip)},
            part="transverse, seven positions",
        )
        for angle in TRANSVERSE_DEG
        for flip in (0, 1)
    )


def _zero_hour() -> tuple[ProgrammeStep, ...]:
    return tuple(
        ProgrammeStep(
            f"rest-{k + 1:02d}",
            f"Zero at {5 * k} min",
            "Nothing is touched: read the output every five minutes for an hour.",
            "read",
            asks=("output",),
            row={"test": "zero"},
            part="zero over an hour",
        )
        for k in range(ZERO_POINTS)
    )


_PERPENDICULAR: Final = "The sensitive axis is perpendicular to the axis of the dividing head."
_LSB: Final = {"output": "LSB"}


def _tilt(identity: str, title: str, mount: str, *tests: tuple[ProgrammeStep, ...]) -> Programme:
    steps = [*_ready(mount)]
    for test in tests:
        steps += test
    return Programme(identity, title, "tilt", TILT_STANDARD, tuple(steps), units=_LSB)


TILT_STATIC: Final = _tilt(
    "tilt-static",
    "Tilt sensor: static test, three ranges of 13 points",
    _PERPENDICULAR,
    _reversal(),
    _static(1, 2, 3),
)
TILT_TRANSVERSE: Final = _tilt(
    "tilt-transverse",
    "Tilt sensor: transverse sensitivity, seven positions",
    f"{_PERPENDICULAR} For the seven positions it is mounted anew, coincident with it.",
    _reversal(),
    _static(1),
    _transverse(),
)
TILT_ZERO: Final = _tilt(
    "tilt-zero",
    "Tilt sensor: stability of the zero over an hour",
    # source 000 has it coincident in its method and perpendicular in its procedure; the 0/180
    # zero needs it perpendicular
    _PERPENDICULAR,
    _reversal(),
    _static(1),
    _zero_hour(),
)
TILT_REVERSAL: Final = _tilt(
    "tilt-reversal",
    "Tilt sensor: 0/180 reversal, tilt of its base",
    _PERPENDICULAR,
    _static(1),
    _reversal("reversal"),
)
COMPASS_SWING: Final = Programme(
    "compass-swing",
    "Compass: swing, deviation A to E",
    "compass",
    "deviation A to E (Archibald Smith 1843)",
    (
        *_ready("The compass sits in its carrier as in use, x along the mark, z up; no iron near."),
        *(
            ProgrammeStep(
                f"heading-{heading:03.0f}",
                f"Heading {heading:g} degrees",
                f"Turn the mark to the known magnetic heading {heading:g} and read the field.",
                "read",
                asks=("mag_x_uT", "mag_y_uT", "mag_z_uT"),
                row={"heading_deg": heading},
                part="swing",
            )
            for heading in SWING_DEG
        ),
    ),
)


def _records(part: str, *items: tuple[str, str, str, Row]) -> tuple[ProgrammeStep, ...]:
    return tuple(
        ProgrammeStep(identity, title, told, "record", row=row, part=part)
        for identity, title, told, row in items
    )


_BOTH: Final = ((1.0, "clockwise"), (-1.0, "anticlockwise"))


def _turned(prefix: str, name: str, row: Row) -> tuple[tuple[str, str, str, Row], ...]:
    return tuple(
        (
            f"{prefix}-{word[:4].rstrip('i')}",
            f"{name}, {word}",
            f"Whole turns {word}, at a constant rate.",
            {**row, "sense": sense},
        )
        for sense, word in _BOTH
    )


FOG_STATION: Final = Programme(
    "fog-station",
    "Gyro on a total station: whole turns, two passes",
    "fog-station",
    "source 001 (Yu, Wang and Wang 2016)",
    (
        ProgrammeStep(
            "level", "Level the table", "Level the table; the theodolite's axis along it."
        ),
        *_ready("The gyro clamped to the telescope, roughly level; write the circle down."),
        *_records("first pass", *_turned("pass-1", "Pass 1", {"pass": 1.0})),
        ProgrammeStep(
            "nearer", "Bring the axis level", "Set the circle to the constant of the first pass."
        ),
        *_records("second pass", *_turned("pass-2", "Pass 2", {"pass": 2.0})),
    ),
    needs="reading-from-elevation=increases table-rate-relative-sigma=1e-4",
)
SIX_POSITION: Final = Programme(
    "six-position",
    "Two-axis table: six positions, whole turns both ways",
    "rate",
    "source 003 (Wu, Sun and Chen)",
    (
        *_ready("The unit on the two-axis table, Z up.", minutes=GYRO_WARM_UP_MIN),
        *(
            step
            for place in SIX
            for step in _records(
                f"position {place}", *_turned(place, f"{place} up", {"position": place})
            )
        ),
    ),
    log_programme="six-position",
    needs="flip-sigma-arcsec=60 table-rate-relative-sigma=1e-4",
)
TEMPERATURE: Final = Programme(
    "temperature",
    "Unit over temperature: -10, 5, 20, 30, 40 C",
    "rate",
    "source 000, calibration of a FOG unit over temperature",
    (
        *_ready("The unit in the hexahedron on the table in the chamber.", minutes=WARM_UP_MIN),
        *(
            step
            for node in NODES_C
            for axis in "xyz"
            for step in _records(
                f"{node:g} C",
                *_turned(
                    f"{node:g}-{axis}",
                    f"{node:g} C, {axis} up",
                    {"position": f"{axis}+", "temperature_c": node},
                ),
            )
        ),
    ),
    log_programme="temperature",
    needs="latitude=",
)
MULTI_POSITION: Final = Programme(
    "multi-position",
    "Hand-held unit: stops in many attitudes",
    "rate",
    "Tedaldi, Pretto and Menegatti 2014",
    (
        *_ready("No mount: the unit is laid down by hand."),
        *_records(
            "stops",
            *(
                (
                    f"stop-{k + 1:02d}",
                    f"Stop {k + 1}",
                    "Lay it down in another attitude, let it lie for five seconds, turn it on.",
                    {"stop": float(k + 1)},
                )
                for k in range(STOPS)
            ),
        ),
    ),
    log_programme="multi-position",
    needs="latitude=",
)
_PHASE_OF: Final = {105: "warm-up", 107: "filter", 112: "level", 113: "run"}
_TOLD_OF: Final = {
    105: "Phase warm-up: 30 min; it ends when the last ten minutes have no trend.",
    107: "Phase filter: at rest.",
    112: "Phase level. A1 no turn; A2 -roll about Y; A3 -pitch about X; A4 Y first, then X.",
    113: "Phase run.",
}
ROTATION: Final = Programme(
    "rotation",
    "North by rotation on line, steps 101 to 113",
    "rate",
    "source 002",
    tuple(
        ProgrammeStep(
            str(number),
            f"{number} {title}",
            _TOLD_OF.get(number, ""),
            "record" if number in _PHASE_OF else "do",
            row={"phase": _PHASE_OF[number]} if number in _PHASE_OF else {},
            part="before" if number < 105 else "recorded" if number in _PHASE_OF else "stated",
        )
        for number, title in STEP_TITLES
    ),
    method="rotation",
    ends_in="north",
    needs="initial-heading-deg= initial-reference=MAGNETIC declination= card=",
)

PROGRAMMES: Final[tuple[Programme, ...]] = (
    TILT_STATIC,
    TILT_TRANSVERSE,
    TILT_ZERO,
    TILT_REVERSAL,
    COMPASS_SWING,
    FOG_STATION,
    SIX_POSITION,
    TEMPERATURE,
    MULTI_POSITION,
    ROTATION,
)
