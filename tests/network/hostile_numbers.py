"""Mutations of a text of observations: what slips, broken disks and attackers make of it."""

from __future__ import annotations

import random
import re

NUMBERS = (
    b"0", b"-0.0", b"1e308", b"-1e308", b"1e-308", b"nan", b"inf", b"1e400", b"", b"-1", b"400",
    b"9" * 400, b"1e9", b"1,5", b"0.0000001", b"-400.0000", b"200", b"1e15", b"x", b"1_0",
)  # fmt: skip
_NUMBER = re.compile(rb"-?\d+\.?\d*")
_WORD = re.compile(rb'"([^"]*)"')


def mutated(data: bytes, rng: random.Random) -> bytes:
    """A sound file with one to three changes."""
    for _ in range(rng.randint(1, 3)):
        data = rng.choice((_byte, _number, _number, _word, _line, _cut))(data, rng)
    return data


def _byte(data: bytes, rng: random.Random) -> bytes:
    place = rng.randrange(len(data) or 1)
    return data[:place] + bytes([rng.randrange(256)]) + data[place + 1 :]


def _number(data: bytes, rng: random.Random) -> bytes:
    found = list(_NUMBER.finditer(data))
    if not found:
        return data
    match = rng.choice(found)
    return data[: match.start()] + rng.choice(NUMBERS) + data[match.end() :]


def _word(data: bytes, rng: random.Random) -> bytes:
    found = list(_WORD.finditer(data))
    if len(found) < 2:
        return data
    match, other = rng.choice(found), rng.choice(found)
    return data[: match.start(1)] + other[1] + data[match.end(1) :]


def _line(data: bytes, rng: random.Random) -> bytes:
    lines = data.split(b"\n")
    place, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[place] = rng.choice((b"", lines[other], lines[place] + lines[other]))
    return b"\n".join(lines)


def _cut(data: bytes, rng: random.Random) -> bytes:
    return data[: rng.randrange(len(data) or 1)] if rng.random() < 0.2 else data
