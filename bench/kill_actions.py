"""Acts that write: killed 200 times each, done by two at once 200 times, and on a full disk.

The state is the old or the new one afterwards, nothing is doubled, no file stays behind.
``SURVEYAPP_ACT=NAME`` takes one act alone and ``SURVEYAPP_PART=kills|pairs|disk`` one part of it;
``SURVEYAPP_FROM``, ``SURVEYAPP_COUNT`` and ``SURVEYAPP_SECONDS`` take some of its moments or pairs.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path
from typing import Final

from bench._parts import FaultsFoundError, Part
from tests.closing.campaign import ACTIONS, Action, campaign, on_a_full_disk, two_at_once

MOMENTS, PAIRS = 200, 200
TOGETHER = ("adopt", "close", "reopen", "new session")


def run() -> list[str]:
    """Some lines an act; a state between old and new raises."""
    wanted, asked = os.environ.get("SURVEYAPP_ACT"), os.environ.get("SURVEYAPP_PART")
    lines: list[str] = []
    faults: list[str] = []
    for number, action in enumerate(ACTIONS):
        for name, work in PARTS.items():
            together = name == "kills" or action.name in TOGETHER
            if wanted in (None, action.name) and asked in (None, name) and together:
                try:
                    lines += [f"{action.name:<12} {told}" for told in work(action, 100 + number)]
                except AssertionError as error:
                    faults.append(f"{action.name:<12} FAULT in {name}: {error}")
    if faults:
        raise FaultsFoundError([*lines, *faults])
    return lines


def _kills(action: Action, seed: int) -> list[str]:
    part = Part(MOMENTS)
    with tempfile.TemporaryDirectory() as place:
        found = campaign(action, Path(place), MOMENTS, seed=seed, part=part)
    return [
        f"{sum(found.values())} kills: {found['old']} old, {found['new']} new, none between; each "
        f"done again; moments {part.told}"
    ]


def _pairs(action: Action, seed: int) -> list[str]:
    part = Part(PAIRS)
    with tempfile.TemporaryDirectory() as place:
        second = two_at_once(action, Path(place), part, seed=seed)
    return [f"{part.done} times by two at once: {second} refused, none doubled; {part.told}"]


def _disk(action: Action, _seed: int) -> list[str]:
    lines = []
    for call in ("write", "fsync", "replace"):
        with tempfile.TemporaryDirectory() as place:
            full = on_a_full_disk(action, Path(place), call)
        lines.append(f"disk full at each of {full} calls of {call}: old state")
    return [*lines, *_tmpfs(action)]


def _tmpfs(action: Action) -> list[str]:
    """The act on file systems that are really full, where this user may mount one."""
    with tempfile.TemporaryDirectory() as place:
        mount = ["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", place]
        if subprocess.run(mount, check=False, capture_output=True).returncode:
            return ["no tmpfs can be mounted here"]
        try:
            states = [_on_tmpfs(action, Path(place), 4096 * pages) for pages in range(12)]
        finally:
            subprocess.run(["umount", place], check=False)
    return [f"full tmpfs, 0 to 11 pages left: {states.count('old')} old, {states.count('new')} new"]


def _on_tmpfs(action: Action, place: Path, room: int) -> str:
    from surveyapp.errors import SurveyError

    folder = place / f"r{room}"
    action.prepare(folder)
    (folder / ".surveyapp.lock").touch()
    state = os.statvfs(place)
    filler = place / "filler"
    with filler.open("wb") as stream:
        stream.write(b"\0" * max(state.f_bavail * state.f_frsize - room, 0))
    try:
        action.act(folder)
        said = "new"
    except SurveyError:
        said = "old"
    found = action.state(folder)
    assert found == said, (action.name, room, found, said)
    filler.unlink()
    subprocess.run(["rm", "-r", str(folder)], check=False)
    return found


PARTS: Final = {"kills": _kills, "pairs": _pairs, "disk": _disk}
