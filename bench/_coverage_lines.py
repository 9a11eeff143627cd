"""Further lines of the coverage bench: what a session does not show of itself.

Every line draws whole projects: the motion is integrated, the field books are written as text, and
what the line is about (an azimuth that was known wrongly, a tilted axis, a bent plumb line) is put
into them by its exact forward model, not by what the estimator believes of it.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench._coverage_sides import EARTH_RADIUS_M, Drawn, Files, forward_and_back, two_instruments
from surveyapp.core.simulate.project import (
    ProjectSession,
    SimulatedProject,
    card_text,
    project_files,
)
from surveyapp.core.simulate.session import SimulatedSession, simulate_sessions
from surveyapp.core.simulate.specification import Noise, SessionSpec, SwingMethod
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, AngleUnit, format_angle, wrap_two_pi
from surveyapp_models.arrays import Floats

Quantity = Literal["gyro", "grid", "combined"]
ENSEMBLE = 25
"""Runs that share damping, clamp and tape zero; everything random is drawn anew for each."""
LATITUDES_DEG = (-33.0, 23.0, 47.0, 62.0)


@dataclass(frozen=True, slots=True)
class Line:
    """One line of the table.

    Parameters
    ----------
    name : str
    quantity : {"gyro", "grid", "combined"}
        Of the session ``run-1``, of its line, or of the side with all its lines.
    draw : callable
        Number of runs and generator to projects.
    before : str
        Coverage that an independent examination found, where it stated one.
    """

    name: str
    quantity: Quantity
    draw: Callable[[int, np.random.Generator], Iterator[Drawn]]
    before: str = ""


Books = dict[str, SimulatedSession]


@dataclass(frozen=True, slots=True)
class Programme:
    """Sessions of one ensemble: how each is specified, by id."""

    specs: dict[str, SessionSpec]
    card: SessionSpec

    def runs(self, size: int, rng: np.random.Generator) -> Iterator[tuple[Books, str]]:
        """Books of all sessions and the card, for so many runs."""
        made = {name: simulate_sessions(spec, size, rng) for name, spec in self.specs.items()}
        for run in range(size):
            yield {name: items[run] for name, items in made.items()}, card_text(self.card, rng)


def base(
    rng: np.random.Generator,
    *,
    latitude_deg: float,
    method: SwingMethod = "tracking",
    points: int = 8,
    noise: Noise | None = None,
) -> SessionSpec:
    """A session as it happens: damping, drifting tape zero, clamp off north, a constant."""
    first = float(rng.uniform(-0.3, 0.3))
    return SessionSpec(
        method=method,
        latitude=math.radians(latitude_deg),
        points=points,
        ratio=float(rng.uniform(0.985, 0.998)),
        constant=float(rng.uniform(-600.0, 600.0)) * ARCSEC,
        clamp_offset=float(rng.uniform(-600.0, 600.0)) * ARCSEC,
        circle_of_north=float(rng.uniform(0.0, 2.0 * math.pi)),
        line_azimuth=float(rng.uniform(0.0, 2.0 * math.pi)),
        tape_zero_div=(first, first + float(rng.uniform(-0.15, 0.15))),
        noise=Noise() if noise is None else noise,
    )


def alone(spec: SessionSpec, card: SessionSpec | None = None) -> Programme:
    """One survey session without a constant."""
    return Programme({"run-1": dataclasses.replace(spec, constant=0.0)}, card or spec)


def both_sides(
    spec: SessionSpec,
    rng: np.random.Generator,
    *,
    calibrations: int = 2,
    surveys: int = 2,
    survey_latitude: float | None = None,
) -> Programme:
    """Calibrations on a known line and surveys of another, each on its own part of the circle."""

    def moved(item: SessionSpec) -> SessionSpec:
        circle = wrap_two_pi(item.circle_of_north + float(rng.uniform(-0.5, 0.5)))
        return dataclasses.replace(
            item, circle_of_north=circle, first_east=bool(rng.random() < 0.5)
        )

    line = wrap_two_pi(spec.line_azimuth + float(rng.uniform(0.5, 2.0)))
    latitude = spec.latitude if survey_latitude is None else survey_latitude
    unknown = dataclasses.replace(spec, line_azimuth=line, latitude=latitude)
    specs = {f"cal-{i + 1}": moved(spec) for i in range(calibrations)}
    specs |= {f"run-{i + 1}": moved(unknown) for i in range(surveys)}
    return Programme(specs, spec)


def files_of(books: Books, card: str) -> Files:
    """The files of one project: calibrations on K1-K2, surveys on U1-U2, marks hit exactly."""
    sessions = tuple(
        ProjectSession(name, "calibration", "K1", "K2", book)
        if name.startswith("cal")
        else ProjectSession(name, "survey", "U1", "U2", book)
        for name, book in books.items()
    )
    files = project_files(SimulatedProject("Coverage", sessions, card))
    own = 'angle_unit = "dms"\ncentring_mm = { instrument = 0.0, target = 0.0 }'
    return files | {"project.toml": files["project.toml"].replace('angle_unit = "dms"', own)}


def turned(book: SimulatedSession, angle: float) -> SimulatedSession:
    """The session with every sight off by so much [rad]."""
    rows = tuple(
        row | {"value": _plus(row["value"], angle)} if row["kind"] == "backsight" else row
        for row in book.rows
    )
    return dataclasses.replace(book, rows=rows)


def _plus(text: str, angle: float) -> str:
    degrees, minutes, seconds = text.split("-")
    value = math.radians(float(degrees) + float(minutes) / 60.0 + float(seconds) / 3600.0)
    return format_angle(wrap_two_pi(value + angle), AngleUnit.DMS, 2)


def known(files: Files, *, error: float = 0.0, sigma: float = 0.0) -> Files:
    """Every known azimuth off by so much, with a stated sigma [rad]."""

    def changed(hit: re.Match[str]) -> str:
        return f'azimuth_known = "{_plus(hit[1], error)}"'

    toml = re.sub(r'azimuth_known = "([^"]*)"', changed, files["project.toml"])
    stated = f"azimuth_known_sigma_arcsec = {sigma * RHO_ARCSEC:.6f}"
    return files | {"project.toml": toml.replace("azimuth_known_sigma_arcsec = 0.0", stated)}


def with_card(files: Files, *, old: str = "", new: str = "") -> Files:
    """The card with a pattern replaced."""
    name = "cards/simulated-gyro.toml"
    return files | {name: re.sub(old, new, files[name])}


def ensembles(count: int) -> Iterator[tuple[int, int]]:
    """Number and size of each ensemble."""
    for number in range(math.ceil(count / ENSEMBLE)):
        yield number, min(ENSEMBLE, count - number * ENSEMBLE)


def _azimuth(books: Books) -> float:
    return books["run-1"].spec.line_azimuth


def five_tape_zeros(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """Five readings of every tape zero, which rule the sigma: a tenth of a division each."""
    noise = Noise(scale_div=0.1, reading=3.0 * ARCSEC)
    for number, size in ensembles(count):
        spec = base(rng, latitude_deg=LATITUDES_DEG[number % 4], points=12, noise=noise)
        for books, card in both_sides(spec, rng).runs(size, rng):
            yield Drawn(files_of(books, card), _azimuth(books))


def known_azimuth(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """The known azimuth is wrong by a normal 10 arc-seconds, and says so."""
    sigma = 10.0 * ARCSEC
    for number, size in ensembles(count):
        spec = base(rng, latitude_deg=LATITUDES_DEG[number % 4])
        for books, card in both_sides(spec, rng).runs(size, rng):
            error = float(rng.normal(scale=sigma))
            files = known(files_of(books, card), error=error, sigma=sigma)
            yield Drawn(files, _azimuth(books))


def steep_sights(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """Sights at z = 30 degrees; the standing axis of every set-up is 10 arc-seconds off plumb.

    A plane through the tilted standing axis and the target: exact rotation, not v cot z.
    """
    zenith = math.radians(30.0)
    for number, size in ensembles(count):
        spec = base(rng, latitude_deg=LATITUDES_DEG[number % 4])
        for books, card in both_sides(spec, rng).runs(size, rng):
            changed = {}
            for name, book in books.items():
                own = book
                if name.startswith("run"):
                    tilt = rng.normal(scale=10.0 * ARCSEC, size=2)
                    own = _steep(turned(book, tilted_reading(zenith, tilt)), zenith)
                changed[name] = own
            yield Drawn(files_of(changed, card), _azimuth(books))


def tilted_reading(zenith: float, tilt: Floats) -> float:
    """Error of a circle reading of a sight [rad] when the standing axis leans along and across.

    The instrument is turned by the tilt about the horizontal axes of the sight (along it, across
    it); in its own axes the target lies elsewhere, and its azimuth there is what the circle shows.
    """
    along, across = tilt
    target = np.array([math.sin(zenith), 0.0, math.cos(zenith)])  # along, to the right, up
    roll = np.array(
        [
            [1.0, 0.0, 0.0],
            [0.0, math.cos(across), -math.sin(across)],
            [0.0, math.sin(across), math.cos(across)],
        ]
    )
    pitch = np.array(
        [
            [math.cos(along), 0.0, math.sin(along)],
            [0.0, 1.0, 0.0],
            [-math.sin(along), 0.0, math.cos(along)],
        ]
    )
    seen = roll @ pitch @ target
    return math.atan2(float(seen[1]), float(seen[0]))


def _steep(book: SimulatedSession, zenith: float) -> SimulatedSession:
    """The book with a zenith angle after its first sight."""
    text = format_angle(zenith, AngleUnit.DMS, 1)
    first = next(i for i, row in enumerate(book.rows) if row["kind"] == "backsight")
    extra = book.rows[first] | {"kind": "zenith", "value": text, "face": "L"}
    rows = [*book.rows[: first + 1], extra, *book.rows[first + 1 :]]
    numbered = tuple(row | {"seq": str(i)} for i, row in enumerate(rows, start=1))
    return dataclasses.replace(book, rows=numbered)


def card_elsewhere(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """Periods of the card measured at 47 degrees, used at 62; tape zero and clamp off north."""
    methods: tuple[SwingMethod, ...] = ("tracking", "amplitude", "transit")
    for number, size in ensembles(count):
        method = methods[number % 3]
        points = 5 if method == "transit" else 8
        spec = base(rng, latitude_deg=62.0, method=method, points=points)
        programme = alone(spec, dataclasses.replace(spec, latitude=math.radians(47.0)))
        for books, card in programme.runs(size, rng):
            yield Drawn(files_of(books, card), _azimuth(books))


def constant_elsewhere(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """The constant determined at 47 degrees, used at 62: it changes by k times sec(latitude)."""
    k = 20.0 * ARCSEC
    for _, size in ensembles(count):
        spec = base(rng, latitude_deg=47.0)
        programme = both_sides(spec, rng, survey_latitude=math.radians(62.0))
        for books, card in programme.runs(size, rng):
            own = float(rng.normal(scale=k))
            moved = {
                name: turned(book, -own / math.cos(book.spec.latitude))
                for name, book in books.items()
            }
            stated = f"[sigma]\nlatitude_arcsec = {k * RHO_ARCSEC:.3f}"
            files = with_card(files_of(moved, card), old=r"\[sigma\]", new=stated)
            yield Drawn(files, _azimuth(books))


def bent_plumb_lines(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """Deflections drawn from a field with a correlation length of 20 km; stations 1 to 30 km apart.

    The program is told nothing but its own default: 5 arc-seconds, 20 km.
    """
    for number, size in ensembles(count):
        apart = (1000.0, 3000.0, 10000.0, 30000.0)[number % 4]
        spec = base(rng, latitude_deg=(47.0, -33.0, 62.0)[number % 3])
        survey = spec.latitude + apart / EARTH_RADIUS_M
        programme = both_sides(spec, rng, survey_latitude=survey)
        near = math.exp(-apart / 20000.0)
        for books, card in programme.runs(size, rng):
            known_east, rest = rng.normal(scale=5.0 * ARCSEC, size=2)
            east = near * known_east + math.sqrt(1.0 - near * near) * rest
            files = known(files_of(books, card), error=-known_east * math.tan(spec.latitude))
            toml = re.sub(r"deflection = .*\n", "", files["project.toml"])
            files |= {"project.toml": toml}
            yield Drawn(files, _azimuth(books) - east * math.tan(survey))


def one_degree_sights(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """One session: four pointings, three unknowns; the pointings rule the sigma."""
    for number, size in ensembles(count):
        sight = (2.0, 5.0, 10.0)[number % 3] * ARCSEC
        noise = Noise(reading=4.0 * ARCSEC, sight=sight)
        spec = base(rng, latitude_deg=LATITUDES_DEG[number % 4], noise=noise)
        for books, card in alone(spec).runs(size, rng):
            yield Drawn(files_of(books, card), _azimuth(books))


def four_points(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """One session of four turning points; the card states no sigma of a turning point."""
    for number, size in ensembles(count):
        noise = Noise(reading=(4.0, 10.0)[number % 2] * ARCSEC)
        spec = base(rng, latitude_deg=LATITUDES_DEG[number % 4], points=4, noise=noise)
        for books, card in alone(spec).runs(size, rng):
            files = with_card(files_of(books, card), old=r"reversal_arcsec = .*\n")
            yield Drawn(files, _azimuth(books))


def small_scatter(count: int, rng: np.random.Generator) -> Iterator[Drawn]:
    """Three calibrations and three surveys whose set-ups scatter less than a run's own sigma."""
    own = 4.0 * 0.362 * ARCSEC  # eight points of 4 arc-seconds (physics.md 2.1)
    for number, size in ensembles(count):
        spec = base(rng, latitude_deg=LATITUDES_DEG[number % 4])
        between = (0.5, 0.75, 1.0)[number % 3] * own
        programme = both_sides(spec, rng, calibrations=3, surveys=3)
        for books, card in programme.runs(size, rng):
            moved = {
                name: turned(book, float(rng.normal(scale=between))) for name, book in books.items()
            }
            yield Drawn(files_of(moved, card), _azimuth(books))


LINES: tuple[Line, ...] = (
    Line("five tape-zero readings", "grid", five_tape_zeros, ".915"),
    Line('known azimuth with 10"', "grid", known_azimuth, ".793"),
    Line('z = 30, levelling 10"', "grid", steep_sights, ".740"),
    Line("card at 47 used at 62", "gyro", card_elsewhere),
    Line("constant at 47 used at 62", "grid", constant_elsewhere),
    Line("deflection field, 20 km", "grid", bent_plumb_lines),
    Line("sights with one dof", "gyro", one_degree_sights, ".928 to .945"),
    Line("four points, no card sigma", "gyro", four_points, ".90"),
    Line("scatter below own sigma", "grid", small_scatter, ".93"),
    Line("side: two instruments", "combined", two_instruments),
    Line("side: forward and back", "combined", forward_and_back),
)
"""The lines of the table."""
