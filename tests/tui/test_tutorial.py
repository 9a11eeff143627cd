"""The tutorial is what the program does: its keys are typed, its screens are compared."""

from __future__ import annotations

import html
import os
import re
from collections import defaultdict
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import Input, Select, TextArea

from surveyapp import api
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.widgets.entry import EntryLine
from tests.tui.helpers_tui import (
    SMALL,
    Clock,
    settle,
)

TUTORIAL = Path(__file__).resolve().parents[2] / "docs" / "tutorials" / "first-orientation.md"
BLOCK = re.compile(r"^```(keys|screen|form)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"n|f\d")


def shown(app: SurveyApp) -> str:
    """The screen as lines of words."""
    lines: dict[float, list[tuple[float, str]]] = defaultdict(list)
    for run in re.finditer(
        r'<text [^>]*?x="([\d.]+)" y="([\d.]+)"[^>]*>(.*?)</text>', app.export_screenshot()
    ):
        lines[float(run[2])].append((float(run[1]), html.unescape(run[3])))
    texts = (" ".join(text for _, text in sorted(runs)) for _, runs in sorted(lines.items()))
    return "\n".join(" ".join(text.replace("\xa0", " ").split()) for text in texts)


async def press(pilot: Pilot[int], clock: Clock, line: str) -> None:
    if line.startswith("wait "):
        clock.pass_by(float(line.removeprefix("wait ")))
    elif NAMED.fullmatch(line):
        await pilot.press(line)
    else:
        text = line.removesuffix(" enter")
        found = pilot.app.screen.query(EntryLine)
        if found:
            found.first().text = text
        else:
            pilot.app.screen.query_one(Input).value = text
        await pilot.press("enter")
    await settle(pilot)


def fill(app: SurveyApp, line: str) -> None:
    name, _, value = line.partition(" = ")
    field = app.screen.query_one(f"#{name}")
    if isinstance(field, TextArea):
        field.text = value.replace(" / ", "\n")
    elif isinstance(field, Select):
        field.value = value
    else:
        assert isinstance(field, Input)
        field.value = value


async def test_the_tutorial_word_for_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    clock = Clock()
    app = SurveyApp(None, now=clock.now, steady=clock.steady)
    blocks = BLOCK.findall(TUTORIAL.read_text(encoding="utf-8"))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        for kind, text in blocks:
            screen = shown(app) if kind == "screen" else ""
            for line in text.splitlines():
                if kind == "keys":
                    await press(pilot, clock, line)
                elif kind == "form":
                    fill(app, line)
                else:
                    assert " ".join(line.split()) in screen, f"{line!r} is not on\n{screen}"
            await settle(pilot)
    assert len(blocks) > 20
    result = api.orient(os.fspath(tmp_path / "ramp3"))
    north = result.sessions[0].gyro_north
    assert north is not None
    assert north.to_dict()["deg"] == pytest.approx(100.0, abs=3.0 * north.sigma * 57.3)
    assert result.lines[0].grid_azimuth is not None
