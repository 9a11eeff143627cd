"""Mutated projects give a Project or a SurveyError, never anything else."""

import json
import random
from pathlib import Path

from surveyapp.domain.project import Project
from surveyapp.errors import SurveyError
from surveyapp.io.project import read_project

PROJECTS = Path(__file__).parents[2] / "projects"
SEED = 20261122
COUNT = 700

TOKENS = (
    b"nan", b"inf", b"-inf", b"1e999", b"9" * 400, b"-0", b"true", b"[]", b"{}", b'""', b"''",
    b"\x00", b"\x1b", b"\xff\xfe", b"\xef\xbb\xbf", b"\r", b"\n", b'"', b",", b";", b"#", b"[[",
    b"]]", b"[" * 2000, b"1979-05-27", b"2026-02-30", b"1_000", b"0x7f", b"400.0", b"360-00-00",
    b"359-59-60", "\u00b2".encode(), "\u0661".encode(), b"\\u0000", b"\\U0010ffff", b"strike",
    b"missed", b"reversal", b"tape_zero", b"transit", b"../..", b"/dev/zero", b"NUL", b"line:-",
)  # fmt: skip

BOOK = """\
seq,time,elapsed_s,kind,value,unit,face,side,target,temperature_c,note
1,2026-11-22T08:00:00Z,0,backsight,40-00-00,dms,L,,B,12.5,"a, note"
2,,10,backsight,220-00-04,dms,R,,B,,
3,,20,tape_zero,5.0,div,,,,,
4,,40,tape_zero,-4.0,div,,,,,
5,,60,tape_zero,4.8,div,,,,,
6,,300,reversal,359-00-00,dms,,L,,,
7,,500,reversal,1-00-00,,,,,,
8,,510,strike,7,,,,,,mistyped
9,,520,reversal,0-59-00,,,,,,
10,,700,missed,,,,,,,
11,,900,reversal,0-58-00,,,,,,
12,,,supply,24.1,V,,,,,
13,,,level_along,4,arcsec,,,,,
14,,1000,zenith,91-00-00,,L,,B,,
15,,,temperature,12,C,,,,,
"""
TOML = """\
format = 1
name = "Mutant"
crs = "EPSG:4546"
angle_unit = "dms"
centring_mm = { instrument = 1.0, target = 1.0 }
[[instrument]]
id = "G"
card = "own.toml"
sigma = { reversal_arcsec = 5.0 }
constant = { arcsec = -9.7, sigma_arcsec = 3.0 }
[[instrument.effect]]
id = "temperature"
coefficients = { a = { value = 1.0, sigma = 0.1, unit = "arcsec" } }
covariance = [[0.01]]
valid = { temperature_c = [1.0, 2.0] }
[[station]]
name = "A"
lat = 35.0
lon = 110.0
deflection = { xi_arcsec = 1.0, eta_arcsec = 2.0 }
[[station]]
name = "B"
e = 1.0
n = 2.0
[[orientation]]
id = "r"
station = "A"
target = "B"
instrument = "G"
method = "tracking"
purpose = "calibration"
azimuth_known = "10-00-00"
constant_choice = "line:A-B"
date = 2026-11-22
eccentric = { distance_m = 0.1, direction = "20-00-00" }
book = "r.csv"
[[traverse]]
name = "t"
book = "r.csv"
[[sensor_log]]
id = "s"
file = "r.csv"
"""
CARD = """\
id = "own"
title = "Own"
kind = "suspended"
source = "own"
scale_value_arcsec = 600.0
[period]
latitude_deg = 47.0
tracking_s = 425.4
clamped_s = 388.3
[torsion]
lambda = 0.2
[range]
temperature_c = [-20.0, 50.0]
"""


def mutate(data: bytes, rng: random.Random) -> bytes:
    """One to three small accidents."""
    text = bytearray(data)
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(text) + 1)
        match rng.randrange(8):
            case 0 if at < len(text):
                text[at] ^= 1 << rng.randrange(8)
            case 1:
                del text[at : at + rng.randint(1, 40)]
            case 2:
                text[at:at] = text[at : at + rng.randint(1, 200)]
            case 3:
                text[at:at] = rng.choice(TOKENS)
            case 4:
                separator = rng.choice((b"\n", b",", b" = "))
                parts = bytes(text).split(separator)
                i, j = rng.randrange(len(parts)), rng.randrange(len(parts))
                parts[i], parts[j] = parts[j], parts[i]
                text = bytearray(separator.join(parts))
            case 5:
                lines = bytes(text).split(b"\n")
                lines.insert(rng.randrange(len(lines) + 1), rng.choice(lines))
                text = bytearray(b"\n".join(lines))
            case 6:
                cells = bytes(text).split(b",")
                cells[rng.randrange(len(cells))] = rng.choice(TOKENS)
                text = bytearray(b",".join(cells))
            case _:
                lines = bytes(text).split(b"\n")
                k = rng.randrange(len(lines))
                key, equals, _ = lines[k].partition(b" = ")
                lines[k] = key + equals + rng.choice(TOKENS) if equals else lines[k]
                text = bytearray(b"\n".join(lines))
    return bytes(text)


def outcome(folder: Path) -> str:
    project: Project | None = None
    try:
        project = read_project(folder)
    except SurveyError as error:
        problems = error.problems
    else:
        problems = ()
    if project is None:
        assert problems
        for problem in problems:
            assert problem.what
            assert len(problem.found) < 100
            json.dumps(problem.to_dict()).encode("utf-8")
        return "refused"
    assert isinstance(project, Project)
    for session in project.sessions:
        for row in session.book.live:
            assert row.value is None or abs(row.value) < 1e7
    return "read"


def test_seeded_mutants_are_read_or_refused(tmp_path: Path) -> None:
    rng = random.Random(SEED)
    valid = {"project.toml": TOML, "r.csv": BOOK, "own.toml": CARD}
    counts = {"read": 0, "refused": 0}
    for name, text in valid.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert outcome(tmp_path) == "read"
    for index in range(COUNT):
        name = rng.choices(tuple(valid), weights=(4, 4, 1))[0]
        (tmp_path / name).write_bytes(mutate(valid[name].encode(), rng))
        counts[outcome(tmp_path)] += 1
        for left in tmp_path.glob("*.torn"):
            left.unlink()
        (tmp_path / name).write_text(valid[name], encoding="utf-8")
        assert index < COUNT
    assert counts["refused"] > COUNT // 4
    assert counts["read"] > COUNT // 20
