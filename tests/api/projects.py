"""Small projects for tests, written as a surveyor would."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

HEAD = "seq,time,elapsed_s,kind,value,unit,face,side,target,temperature_c,note"

GYRO = """
[[instrument]]
id = "G1"
card = "card.toml"
"""

CARD = """
id = "test-gyro"
title = "Test gyro"
kind = "suspended"
source = "invented for a test"
scale_value_arcsec = 600.0
[period]
latitude_deg = 47.0
tracking_s = 425.4
clamped_s = 388.3
sigma_s = 0.1
[sigma]
reversal_arcsec = 5.0
azimuth_arcsec = 4.0
scale_div = 0.02
time_s = 0.1
[tape_zero]
limit_div = 0.5
"""


def rows(*lines: str) -> str:
    """Field-book text from ``kind,value,face,side,target`` lines."""
    text = [HEAD]
    for seq, line in enumerate(lines, 1):
        kind, value, face, side, target = (line.split(",") + [""] * 4)[:5]
        text.append(f"{seq},,,{kind},{value},,{face},{side},{target},,")
    return "\n".join(text) + "\n"


def write(
    folder: Path, toml: str, books: Mapping[str, str], *, card: str = CARD, head: str = ""
) -> Path:
    """Write a project folder and return it."""
    (folder / "observations").mkdir(parents=True, exist_ok=True)
    (folder / "project.toml").write_text(f'format = 1\nname = "Test"\n{head}\n{toml}')
    (folder / "card.toml").write_text(card)
    for name, text in books.items():
        (folder / "observations" / f"{name}.csv").write_text(text)
    return folder


def session(identity: str, station: str, target: str, *, more: Sequence[str] = ()) -> str:
    """One [[orientation]] table of an automatic gyro unless ``more`` says otherwise."""
    lines = [
        "[[orientation]]",
        f'id = "{identity}"',
        f'station = "{station}"',
        f'target = "{target}"',
        'instrument = "G1"',
        f'book = "observations/{identity}.csv"',
        *more,
    ]
    if not any(line.startswith("method") for line in more):
        lines.append('method = "automatic"')
    return "\n".join(lines) + "\n"


def station(name: str, *, e: float, n: float, more: str = "") -> str:
    """One [[station]] table."""
    return f'[[station]]\nname = "{name}"\ne = {e}\nn = {n}\n{more}\n'


def azimuths(*values: str) -> str:
    """Book of an automatic gyro."""
    return rows(*(f"azimuth,{value}" for value in values))


TM = 'crs = "+proj=tmerc +lat_0=0 +lon_0=9 +k=1 +x_0=0 +y_0=0 +ellps=GRS80 +units=m +type=crs"\n'
