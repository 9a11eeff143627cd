"""The progress bar: after a second, on a terminal only, gone before the result."""

from __future__ import annotations

import io
import sys
import time

import pytest

from surveyapp.cli import waiting
from surveyapp.cli.main import COMMANDS, main
from surveyapp.cli.waiting import Waiting


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_it_says_what_is_done_and_for_how_long() -> None:
    bar = Waiting("orient", None)
    assert bar.text(3.4) == "orient  3 s"
    bar.advance("sessions reduced", 250, 1000)
    assert bar.text(12.0) == "orient  [######..................] sessions reduced 250 of 1000  12 s"
    bar.advance("pages", 17, 0)
    assert bar.text(1.0) == "orient  pages 17  1 s"


def test_it_is_drawn_and_gone_before_the_first_word(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "PATIENCE_S", 0.0)
    monkeypatch.setattr(waiting, "BEAT_S", 0.01)
    error, output = Terminal(), io.StringIO()
    monkeypatch.setattr(sys, "stdout", output)
    with Waiting("orient", error) as bar:
        bar.advance("sessions reduced", 1, 2)
        begin = time.monotonic()
        while "1 of 2" not in error.getvalue() and time.monotonic() - begin < 10.0:
            time.sleep(0.01)
        print("the result")
        after = error.getvalue()
        time.sleep(0.05)
    assert "1 of 2" in after
    assert error.getvalue() == after, "nothing is drawn behind the result"
    assert after.endswith("\r")
    assert after.rsplit("\r", 2)[1].strip() == ""
    assert output.getvalue() == "the result\n"
    assert sys.stdout is output


def test_nothing_is_written_where_nobody_looks(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["models"]) == 0
    assert capsys.readouterr().err == ""


def test_screens_have_no_bar() -> None:
    assert {c.name for c in COMMANDS if not c.waits} >= {"open", "practise", "batch"}
    assert {c.name for c in COMMANDS if c.waits} >= {"orient", "check", "adjust", "report"}
