"""Instrument cards: installed ones, the user's own, and what a project overrides.

A value that the card does not state stays None. A card that contradicts itself (periods against
the torsion ratio, or against the transit constant) is refused with both numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Final, cast

from surveyapp.domain.instrument import (
    InstrumentCard,
    InstrumentKind,
    Periods,
    ReadingSigmas,
    TapeZeroCard,
    ValidRange,
)
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import decode, read_inside, shown
from surveyapp.io.findings import Findings
from surveyapp.io.tables import Table, as_number, parse_toml
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC

CARD_KEYS: Final = (
    "title",
    "kind",
    "source",
    "scale_value_arcsec",
    "resolution_arcsec",
    "calibration_due",
    "period",
    "torsion",
    "transit",
    "sigma",
    "tape_zero",
    "range",
    "notes",
)
"""Every key of a card that a project may override; ``id`` is the card's own."""
SUPPLY_KEYS: Final = {"supply_v": "V", "supply_hz": "Hz", "supply_ma": "mA"}
"""Ranges of the supply in [range] by their unit."""

_POLAR_DEG: Final = 85.0
"""Beyond this latitude nobody measures the period or the tape zero of a suspended gyro: it finds no
north there, and values carried from there to another latitude would be beyond all bounds."""

SMALLEST_DIVISION: Final = 0.1 * ARCSEC
"""No scale of a gyro is divided more finely; a smaller value is a slip (and would overflow)."""
_AGREEMENT: Final = 0.05
"""Two statements of one quantity that differ by more contradict each other (physics.md 1.4)."""


def installed_card_ids() -> tuple[str, ...]:
    """Ids of the cards that come with the program, sorted."""
    folder = resources.files("surveyapp_models").joinpath("instruments")
    return tuple(sorted(item.name[:-5] for item in folder.iterdir() if item.name.endswith(".toml")))


def is_path(name: str) -> bool:
    """Whether a card or rule book is named by its path and not by its id."""
    return "/" in name or "\\" in name or name.endswith(".toml")


def read_card(name_or_path: str, *, base: Path, override: Mapping[str, object]) -> InstrumentCard:
    """Read a card and apply what a project overrides.

    Parameters
    ----------
    name_or_path : str
        Id of an installed card, or a path to one's own, relative to ``base``.
    base : Path
        Folder of the file that names the card.
    override : mapping
        Card keys that replace those of the card; tables are merged key by key.

    Returns
    -------
    InstrumentCard

    Raises
    ------
    SurveyError
        For an unknown card (naming the nearest), and with every problem of the card together.
    """
    findings = Findings()
    card = load_card(name_or_path, base=base, override=override, findings=findings)
    findings.raise_if_any()
    if card is None:  # pragma: no cover - a card is None only with a problem
        raise SurveyError(Problem("the card cannot be used", name_or_path))
    return card


def load_card(
    name_or_path: str,
    *,
    base: Path,
    override: Mapping[str, object],
    findings: Findings,
    where: str = "",
) -> InstrumentCard | None:
    """As ``read_card``, but with problems and warnings noted in ``findings``.

    ``where`` is the place that names the card.
    """
    try:
        text = card_text(name_or_path, base=base, where=where)
        data = parse_toml(text, where=said("card {name_or_path}", name_or_path=shown(name_or_path)))
    except SurveyError as error:
        findings.absorb(error)
        return None
    merged = _merged(data, override)
    where = f"card {shown(name_or_path)}" + (" with its overrides" if override else "")
    before = len(findings.problems)
    card = _card(Table(merged, where, findings))
    return card if len(findings.problems) == before else None


def card_text(name: str, base: Path, where: str) -> str:
    """Text of a card, installed or of one's own inside ``base``; ``where`` names it."""
    if is_path(name):
        place = f"{where}, card {shown(name)}".lstrip(", ")
        return decode(read_inside(base, name, where=place), where=place)
    known = installed_card_ids()
    if name not in known:
        raise SurveyError(
            Problem(
                "there is no such instrument card",
                f"{where}, card".lstrip(", "),
                shown(name),
                "the id of an installed card, or a path to your own ending in .toml",
                nearest_names(name, known),
            )
        )
    folder = resources.files("surveyapp_models").joinpath("instruments")
    return folder.joinpath(f"{name}.toml").read_text(encoding="utf-8")


def _merged(card: Mapping[str, object], override: Mapping[str, object]) -> dict[str, object]:
    merged = dict(card)
    for key, value in override.items():
        ours = merged.get(key)
        if isinstance(ours, Mapping) and isinstance(value, Mapping):
            merged[key] = {**ours, **value}
        else:
            merged[key] = value
    return merged


def _card(table: Table) -> InstrumentCard:
    periods = _periods(table)
    scale_value = _scaled(table, "scale_value_arcsec", low=-36000.0, high=36000.0)
    if scale_value is not None and abs(scale_value) < SMALLEST_DIVISION:
        found = scale_value / ARCSEC
        table.problem(
            "scale_value_arcsec is out of range",
            found,
            "a number that is not 0: at least 0.1 either way",
        )
        scale_value = None
    torsion, torsion_sigma = _torsion(table, periods)
    transit, transit_sigma = _transit(table, periods)
    _check_agreement(table, periods, torsion, (transit, scale_value))
    due = table.date("calibration_due")
    card = InstrumentCard(
        id=table.text("id", required=True) or "",
        title=table.text("title", required=True) or "",
        kind=cast(
            "InstrumentKind",
            table.choice("kind", ("suspended", "automatic"), required=True) or "suspended",
        ),
        source=table.text("source", required=True, multiline=True) or "",
        scale_value=scale_value,
        periods=periods,
        torsion_lambda=torsion,
        torsion_sigma=torsion_sigma,
        transit_c=transit,
        transit_c_sigma=transit_sigma,
        sigma=_sigmas(table),
        tape_zero=_tape_zero(table),
        valid=_range(table),
        resolution=_scaled(table, "resolution_arcsec", high=36000.0, positive=True),
        calibration_due=None if due is None else due.isoformat(),
        notes=_notes(table),
    )
    table.warn_unknown()
    return card


def _scaled(
    table: Table, key: str, *, low: float = 0.0, high: float = 1e6, positive: bool = False
) -> float | None:
    """Read arc-seconds (per whatever) and return radians."""
    value = table.number(key, low=low, high=high, positive=positive)
    return None if value is None else value * ARCSEC


def _latitude(table: Table, key: str = "latitude_deg", *, required: bool = False) -> float | None:
    value = table.number(key, low=-_POLAR_DEG, high=_POLAR_DEG, required=required)
    return None if value is None else math.radians(value)


def _periods(card: Table) -> Periods | None:
    table = card.table("period")
    if table is None:
        return None
    latitude = _latitude(table, required=True)
    values = [
        table.number(key, high=1e5, positive=True)
        for key in ("tracking_s", "clamped_s", "unspun_s", "sigma_s")
    ]
    table.warn_unknown()
    return None if latitude is None else Periods(latitude, *values)


def _torsion(card: Table, periods: Periods | None) -> tuple[float | None, float | None]:
    table = card.table("torsion")
    if table is None:
        return None, None
    value = table.number("lambda", high=100.0, positive=True)
    sigma = table.number("sigma", low=0.0, high=100.0)
    table.warn_unknown()
    if value is not None and periods is None:
        card.problem("torsion.lambda stands without its latitude", value, "[period] latitude_deg")
    return value, sigma


def _transit(card: Table, periods: Periods | None) -> tuple[float | None, float | None]:
    table = card.table("transit")
    if table is None:
        return None, None
    value = _scaled(table, "c_arcsec_per_div_s", low=-1e4, high=1e4)
    sigma = _scaled(table, "sigma_arcsec_per_div_s", low=0.0, high=1e4)
    table.warn_unknown()
    if value is not None and periods is None:
        card.problem("transit.c_arcsec_per_div_s stands without its latitude", "", "[period]")
    return value, sigma


def _check_agreement(
    table: Table,
    periods: Periods | None,
    torsion: float | None,
    transit: tuple[float | None, float | None],
) -> None:
    """Refuse a card whose statements of one quantity differ by more than 5 %."""
    if periods is None or periods.tracking_s is None or periods.clamped_s is None:
        return
    t1, t2 = periods.tracking_s, periods.clamped_s
    if t2 >= t1:
        table.problem(
            "the clamped period is not shorter than the tracking period",
            f"tracking_s {t1:g}, clamped_s {t2:g}",
            "tracking_s (T1) longer than clamped_s (T2)",
            "the torsion of the tape shortens the clamped period: are they exchanged?",
        )
        return
    expected = (t1 / t2) ** 2 - 1.0  # lambda = T1^2/T2^2 - 1
    if torsion is not None and abs(torsion / expected - 1.0) > _AGREEMENT:
        table.problem(
            "torsion.lambda contradicts the periods",
            f"lambda {torsion:.4g}",
            said("{expected:.4g} from T1 and T2, within 5 %", expected=expected),
            "one of the three is wrong, or they were measured at different latitudes",
        )
    c, mu = transit
    if c is None or mu is None or mu == 0.0:
        return
    theory = 0.5 * math.pi * mu * t1**2 / t2**3  # C = (pi/2) mu T1^2 / T2^3
    if abs(c / theory - 1.0) > _AGREEMENT:
        table.problem(
            "transit.c_arcsec_per_div_s contradicts the periods and the scale value",
            f"C {c / ARCSEC:.4g}",
            said("{value:.4g} from T1, T2 and the scale value, within 5 %", value=theory / ARCSEC),
            "a printed C may be in arc-minutes, in mgon, or for another definition of dt",
        )


def _sigmas(card: Table) -> ReadingSigmas:
    table = card.table("sigma")
    if table is None:
        return ReadingSigmas()
    sigmas = ReadingSigmas(
        reversal=_scaled(table, "reversal_arcsec", positive=True),
        azimuth=_scaled(table, "azimuth_arcsec", positive=True),
        scale_div=table.number("scale_div", high=1e4, positive=True),
        time_s=table.number("time_s", high=1e4, positive=True),
        level=_scaled(table, "level_arcsec", high=36000.0),
        graduation=_scaled(table, "graduation_arcsec", high=36000.0),
        twist=_scaled(table, "twist_arcsec", high=36000.0),
        refraction=_scaled(table, "refraction_arcsec", high=36000.0),
        observer=_scaled(table, "observer_arcsec", high=36000.0),
        temperature=_scaled(table, "temperature_arcsec_per_c", high=36000.0),
        latitude=_scaled(table, "latitude_arcsec", high=36000.0),
    )
    table.warn_unknown()
    return sigmas


def _tape_zero(card: Table) -> TapeZeroCard:
    table = card.table("tape_zero")
    if table is None:
        return TapeZeroCard()
    tilt = table.number("div_per_arcsec_tilt", low=-1e3, high=1e3)
    values = TapeZeroCard(
        limit_div=table.number("limit_div", high=1e4, positive=True),
        div_per_tilt=None if tilt is None else tilt / ARCSEC,
        correction_per_div=_scaled(table, "correction_arcsec_per_div", low=-36000.0, high=36000.0),
        latitude=_latitude(table),
        correction_sigma=_scaled(table, "correction_sigma_arcsec_per_div", high=36000.0),
    )
    table.warn_unknown()
    return values


def _range(card: Table) -> ValidRange:
    table = card.table("range")
    if table is None:
        return ValidRange()
    latitude = table.number("latitude_max_deg", high=90.0, positive=True)
    supply = [
        (unit, *pair)
        for key, unit in SUPPLY_KEYS.items()
        if (pair := _pair(table, key)) is not None
    ]
    level = table.number("level_arcsec", high=36000.0, positive=True)
    zenith = _pair(table, "zenith_deg")
    temperature = _pair(table, "temperature_c")
    table.warn_unknown()
    return ValidRange(
        latitude_max=None if latitude is None else math.radians(latitude),
        temperature_c=temperature,
        supply=tuple(supply),
        level=None if level is None else level * ARCSEC,
        zenith=None if zenith is None else (math.radians(zenith[0]), math.radians(zenith[1])),
    )


def _pair(table: Table, key: str) -> tuple[float, float] | None:
    value = table.get(key)
    if value is None:
        return None
    pair = number_pair(value)
    if pair is None:
        table.problem(said("{key} is no range", key=key), value, "[lowest, highest]")
    return pair


def number_pair(value: object) -> tuple[float, float] | None:
    """Increasing pair of finite numbers from a TOML array, else None."""
    if not isinstance(value, list) or len(value) != 2:
        return None
    low, high = as_number(value[0]), as_number(value[1])
    return None if low is None or high is None or low > high else (low, high)


def _notes(card: Table) -> tuple[tuple[str, str], ...]:
    table = card.table("notes")
    if table is None:
        return ()
    return tuple(
        (key, value if isinstance(value, str) else str(value)) for key, value in table.data.items()
    )
