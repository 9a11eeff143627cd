"""Acts that write: killed 200 times each, done by two at once 200 times, and on a full disk.

The state is the old or the new one afterwards, nothing is doubled, no file stays behind.
``SURVEYAPP_ACT=NAME`` takes one act alone.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

from tests.closing.campaign import ACTIONS, Action, campaign, on_a_full_disk, two_at_once

MOMENTS, PAIRS = 200, 200
TOGETHER = ("adopt", "close", "reopen", "new session")


def run() -> list[str]:
    """Some lines an act; a state between old and new raises."""
    wanted = os.environ.get("SURVEYAPP_ACT")
    lines = []
    for number, action in enumerate(ACTIONS):
        if wanted in (None, action.name):
            lines += _act(action, 100 + number)
    return lines


def _act(action: Action, seed: int) -> list[str]:
    with tempfile.TemporaryDirectory() as place:
        found = campaign(action, Path(place), MOMENTS, seed)
    lines = [
        f"{action.name:<12} {sum(found.values())} kills: {found['old']} old, {found['new']} new, "
        "none between; each done again"
    ]
    if action.name not in TOGETHER:
        return lines
    with tempfile.TemporaryDirectory() as place:
        second = two_at_once(action, Path(place), PAIRS, seed)
    lines.append(f"{action.name:<12} {PAIRS} times by two at once: {second} refused, none doubled")
    for call in ("write", "fsync", "replace"):
        with tempfile.TemporaryDirectory() as place:
            full = on_a_full_disk(action, Path(place), call)
        lines.append(f"{action.name:<12} disk full at each of {full} calls of {call}: old state")
    return [*lines, *_tmpfs(action)]


def _tmpfs(action: Action) -> list[str]:
    """The act on file systems that are really full, where this user may mount one."""
    with tempfile.TemporaryDirectory() as place:
        mount = ["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", place]
        if subprocess.run(mount, check=False, capture_output=True).returncode:
            return [f"{action.name:<12} no tmpfs can be mounted here"]
        try:
            states = [_on_tmpfs(action, Path(place), 4096 * pages) for pages in range(12)]
        finally:
            subprocess.run(["umount", place], check=False)
    return [
        f"{action.name:<12} full tmpfs, 0 to 11 pages left: {states.count('old')} old, "
        f"{states.count('new')} new"
    ]


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
