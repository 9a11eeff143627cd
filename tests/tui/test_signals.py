"""A program that the system ends gives the terminal back; one without a terminal says so."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import termios
from pathlib import Path

import pexpect
import pytest

from tests.tui.helpers_tui import make_project

ROOT = Path(__file__).resolve().parents[2]
LEAVES_SCREEN = b"\x1b[?1049l"
SHOWS_CURSOR = b"\x1b[?25h"


def environment(tmp_path: Path) -> os._Environ[str] | dict[str, str]:
    return {
        **os.environ,
        "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'models'}",
        "TERM": "xterm-256color",
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "TEXTUAL_ANIMATIONS": "none",
    }


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGQUIT"])
def test_a_signal_leaves_the_terminal_as_it_was(name: str, tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    child = pexpect.spawn(
        sys.executable,
        ["-m", "surveyapp", "open", str(folder)],
        env=environment(tmp_path),
        dimensions=(24, 80),
        timeout=60,
    )
    before = termios.tcgetattr(child.child_fd)
    child.expect(rb"3083-3082|Sessions")
    during = termios.tcgetattr(child.child_fd)
    assert during[3] & termios.ECHO == 0  # the screens take the keys themselves
    number = getattr(signal, name)
    os.kill(child.pid, number)
    child.expect(pexpect.EOF)
    said = child.before or b""
    child.close()
    assert LEAVES_SCREEN in said
    assert SHOWS_CURSOR in said
    assert child.exitstatus == 128 + int(number), (child.exitstatus, child.signalstatus)
    assert before[3] & termios.ECHO
    assert not list(folder.rglob("*.tmp"))


@pytest.mark.parametrize("arguments", [[], ["open", "p"], ["practise"]])
def test_without_a_terminal_it_says_so_and_ends_with_2(
    arguments: list[str], tmp_path: Path
) -> None:
    make_project(tmp_path / "p")
    done = subprocess.run(
        [sys.executable, "-m", "surveyapp", *arguments],
        cwd=tmp_path,
        env=environment(tmp_path),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 2
    assert b"need a terminal" in done.stderr
    assert b"\x1b" not in done.stdout + done.stderr
