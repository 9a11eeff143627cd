"""A simulated campaign made into a project: a session of an automatic gyro per determination."""

from __future__ import annotations

import math
from datetime import datetime, timedelta
from typing import Any

from surveyapp.core.simulate.campaign import CAMPAIGN_EFFECTS, SimulatedCampaign
from surveyapp.core.simulate.project import station_pair, toml_head
from surveyapp.core.simulate.session import Row, book_text, circle_text
from surveyapp.domain.readings import COLUMNS
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, AngleUnit, format_angle, wrap_two_pi


def campaign_files(
    campaign: SimulatedCampaign, *, name: str = "Simulated campaign"
) -> dict[str, str]:
    """Return the text of each file of the project by its relative path, truth not included."""
    spec = campaign.spec
    count = campaign.elapsed_days.size
    lines = {int(campaign.line[i]): i for i in range(count)}
    parts = [toml_head(name, "cards/simulated-automatic.toml")]
    for _, index in sorted(lines.items()):
        parts.append(
            station_pair(
                _names(campaign, index),
                latitude=float(campaign.latitude[index]),
                azimuth=float(campaign.azimuth[index]),
                known=not _is_survey(campaign, index),
            )
        )
    parts += [_orientation(campaign, index) for index in range(count)]
    files = {"project.toml": "\n".join(parts)}
    files["cards/simulated-automatic.toml"] = f"""id = "simulated-automatic"
title = "Simulated automatic gyro"
kind = "automatic"
source = "simulated"

[sigma]
azimuth_arcsec = {spec.sigma_round * RHO_ARCSEC:.3f}
"""
    for index in range(count):
        files[f"observations/{_identity(campaign, index)}.csv"] = book_text(_rows(campaign, index))
    return files


def campaign_truth(campaign: SimulatedCampaign) -> dict[str, Any]:
    """Return the truth of a campaign, for a file that no other command reads."""
    kinds = {kind.id: kind for kind in CAMPAIGN_EFFECTS}
    return {
        "schema": "surveyapp.truth/1",
        "origin": "simulated campaign",
        "effects": [
            {
                "id": effect.id,
                "size": effect.size / kinds[effect.id].to_internal,
                "unit": kinds[effect.id].unit,
                "options": dict(effect.options),
            }
            for effect in campaign.spec.effects
        ],
        "drawn": campaign.drawn,
        "constant_arcsec": campaign.spec.constant * RHO_ARCSEC,
        "sessions": {
            _identity(campaign, index): {
                "azimuth_deg": math.degrees(wrap_two_pi(float(campaign.azimuth[index]))),
                "constant_arcsec": float(campaign.true_constant[index]) * RHO_ARCSEC,
            }
            for index in range(campaign.elapsed_days.size)
        },
    }


def _is_survey(campaign: SimulatedCampaign, index: int) -> bool:
    return index >= campaign.spec.determinations


def _identity(campaign: SimulatedCampaign, index: int) -> str:
    if _is_survey(campaign, index):
        return f"later-{index - campaign.spec.determinations + 1:02d}"
    return f"det-{index + 1:03d}"


def _names(campaign: SimulatedCampaign, index: int) -> tuple[str, str]:
    if _is_survey(campaign, index):
        return "U1", "U2"
    number = int(campaign.line[index]) + 1
    return f"K{number}A", f"K{number}B"


def _spin_up(campaign: SimulatedCampaign, index: int) -> datetime:
    """The moment of spin-up of that day: zero of the book's elapsed seconds."""
    begin = campaign.spec.start + timedelta(days=float(campaign.elapsed_days[index]))
    moment = begin + timedelta(seconds=float(campaign.running_s[0] - campaign.running_s[index]))
    return moment.replace(microsecond=0)


def _orientation(campaign: SimulatedCampaign, index: int) -> str:
    station, target = _names(campaign, index)
    survey = _is_survey(campaign, index)
    known = ""
    if not survey:
        text = format_angle(wrap_two_pi(float(campaign.azimuth_known[index])), AngleUnit.DMS, 3)
        known = f'azimuth_known = "{text}"\nazimuth_known_sigma_arcsec = 0.0\n'
    identity = _identity(campaign, index)
    reference = campaign.spec.reference_temperature_c
    return (
        f'[[orientation]]\nid = "{identity}"\nstation = "{station}"\ntarget = "{target}"\n'
        f'instrument = "G1"\nmethod = "automatic"\n'
        f'purpose = "{"survey" if survey else "calibration"}"\n'
        f"date = {_spin_up(campaign, index).date().isoformat()}\norder = {index + 1}\n{known}"
        f"reference_temperature_c = {reference}\n"
        f'book = "observations/{identity}.csv"\n'
    )


def _rows(campaign: SimulatedCampaign, index: int) -> tuple[Row, ...]:
    """Sights, rounds of north, sights; elapsed seconds count from the spin-up."""
    middle = float(campaign.running_s[index])
    sights = campaign.line_reading[index]
    rounds = int(campaign.rounds[index])
    entries: list[tuple[float, str, float, str]] = []
    for moment, pair in ((middle - 240.0, sights[0]), (middle + 240.0, sights[1])):
        entries.append((moment, "backsight", float(pair[0]), "L"))
        entries.append((moment + 30.0, "backsight", float(pair[1]), "R"))
    for number in range(rounds):
        moment = middle + 120.0 * (number - 0.5 * (rounds - 1))
        entries.append((moment, "north", float(campaign.north_reading[index, number]), ""))
    entries.sort(key=lambda entry: entry[0])
    rows = []
    for seq, (moment, kind, value, face) in enumerate(entries, start=1):
        row = dict.fromkeys(COLUMNS, "")
        row.update(seq=str(seq), kind=kind, value=circle_text(value, 0.1 * ARCSEC), unit="dms")
        row.update(face=face, elapsed_s=f"{moment:.1f}")
        time = _spin_up(campaign, index) + timedelta(seconds=round(moment, 1))
        row.update(time=time.isoformat(timespec="milliseconds"))
        row.update(temperature_c=f"{campaign.temperature_c[index]:.1f}")
        rows.append(row)
    return tuple(rows)
