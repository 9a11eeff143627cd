"""Mutated projects give a Project or a SurveyError, never anything else."""

import json
from collections.abc import Sized
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import given, seed, settings
from hypothesis import strategies as st

from surveyapp.domain.project import Project
from surveyapp.errors import SurveyError
from surveyapp.io.project import read_project

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
coefficients = { coefficient = { value = 1.0, sigma = 0.1, unit = "arcsec/K" } }
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
[[station]]
name = "C"
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
book = "t.csv"
[[sensor_log]]
id = "s"
file = "r.csv"
"""
TRAVERSE = """\
kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note
angle,A,C,B,90-00-00,dms,7,arcsec,1,,,
distance,A,,B,100.0,,2+2,mm+ppm,,,,
zenith,A,,B,91-00-00,,10,arcsec,,1.5,1.6,steep
azimuth,A,,B,45-00-00,,10,arcsec,,,,
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


Accident = tuple[int, float, float, bytes]
ACCIDENTS = st.lists(
    st.tuples(st.integers(0, 7), st.floats(0, 1), st.floats(0, 1), st.sampled_from(TOKENS)),
    min_size=1,
    max_size=3,
)


def at(sequence: Sized, share: float) -> int:
    """Index of a share of a sequence that is not empty."""
    return min(int(share * len(sequence)), len(sequence) - 1)


def mutate(data: bytes, accident: Accident) -> bytes:
    """One small accident: bits, deletions, doublings, exchanged fields, wild values."""
    kind, here, there, token = accident
    text = bytearray(data or b"\n")
    i = at(text, here)
    match kind:
        case 0:
            text[i] ^= 1 << at(range(8), there)
        case 1:
            del text[i : i + 1 + at(range(40), there)]
        case 2:
            text[i:i] = text[i : i + 1 + at(range(200), there)]
        case 3:
            text[i:i] = token
        case 4:
            separator = (b"\n", b",", b" = ")[len(token) % 3]
            parts = bytes(text).split(separator)
            j, k = at(parts, here), at(parts, there)
            parts[j], parts[k] = parts[k], parts[j]
            return separator.join(parts)
        case 5:
            lines = bytes(text).split(b"\n")
            lines.insert(at(lines, here), lines[at(lines, there)])
            return b"\n".join(lines)
        case 6:
            cells = bytes(text).split(b",")
            cells[at(cells, here)] = token
            return b",".join(cells)
        case _:
            lines = bytes(text).split(b"\n")
            j = at(lines, here)
            key, equals, _ = lines[j].partition(b" = ")
            lines[j] = key + equals + token if equals else lines[j]
            return b"\n".join(lines)
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


VALID = {"project.toml": TOML, "r.csv": BOOK, "t.csv": TRAVERSE, "own.toml": CARD}
TARGETS = st.sampled_from([*["project.toml"] * 4, *["r.csv"] * 3, *["t.csv"] * 2, "own.toml"])
COUNTS = {"read": 0, "refused": 0}


@given(name=TARGETS, accidents=ACCIDENTS)
@seed(20261122)
@settings(max_examples=700, deadline=None, database=None)
def check_one_mutant(name: str, accidents: list[Accident]) -> None:
    data = VALID[name].encode()
    for accident in accidents:
        data = mutate(data, accident)
    with TemporaryDirectory() as folder:
        for other, text in VALID.items():
            Path(folder, other).write_bytes(data if other == name else text.encode())
        COUNTS[outcome(Path(folder))] += 1


def test_seven_hundred_seeded_mutants_are_read_or_refused(tmp_path: Path) -> None:
    for name, text in VALID.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert outcome(tmp_path) == "read"
    check_one_mutant()
    assert sum(COUNTS.values()) >= 500
    assert COUNTS["refused"] > 100
    assert COUNTS["read"] > 50
