"""In every language no key label and no title is cut on the smallest screen, and results are told.

The screens read their texts when their modules are loaded: each language loads them anew.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from textual.widgets._footer import FooterKey

from surveyapp import languages
from surveyapp.core.simulate.session import book_text
from tests.tui.helpers_tui import SMALL, make_project, simulated

ROOT = Path(__file__).resolve().parents[2]
SCREENS = "surveyapp.tui"
OTHERS = ("de", "ru", "zh")


def _loaded() -> dict[str, Any]:
    return {name: module for name, module in sys.modules.items() if name.startswith(SCREENS)}


@pytest.fixture(params=OTHERS)
def language(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[str]:
    """Screens in one language; afterwards those of the other tests are put back."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("TEXTUAL_ANIMATIONS", "none")
    before = _loaded()
    for name in before:
        del sys.modules[name]
    languages.use(request.param)
    yield str(request.param)
    languages.use("en")
    for name in _loaded():
        del sys.modules[name]
    sys.modules.update(before)
    sys.modules["surveyapp"].tui = before.get(SCREENS)  # type: ignore[attr-defined]


def cut_labels(app: Any) -> list[str]:
    """Key labels of the footer that stand beyond the right edge, or under the palette's."""
    keys = list(app.screen.query(FooterKey))
    palette = [key.region.x for key in keys if key.has_class("-command-palette")]
    edge = min([app.size.width, *palette])
    return [
        str(key.render())
        for key in keys
        if not key.has_class("-command-palette") and key.region.right > edge
    ]


def cut_title(app: Any) -> list[str]:
    """Titles and states that are wider than what they have."""
    found = []
    for name in ("#title", "#state"):
        for part in app.screen.query(name):
            text = str(part.render())
            if languages_width(text) > part.region.width:
                found.append(f"{text!r} in {part.region.width} columns")
    return found


def languages_width(text: str) -> int:
    from surveyapp.report.text import display_width

    return display_width(text)


async def seen(app: Any, keys: tuple[str, ...], size: tuple[int, int] = SMALL) -> str:
    """All that a screen shows, after keys; what is cut is a failure."""
    async with app.run_test(size=size) as pilot:
        await pilot.pause()
        for key in keys:
            await pilot.app.workers.wait_for_complete()
            await pilot.press(key)
            await pilot.pause()
        await pilot.app.workers.wait_for_complete()
        await pilot.pause()
        assert cut_labels(app) == []
        assert cut_title(app) == []
        lines = app.screen._compositor.render_strips()
        return "\n".join("".join(segment.text for segment in strip) for strip in lines)


def own_copy(tmp_path: Path, name: str) -> str:
    return str(shutil.copytree(ROOT / "projects" / name, tmp_path / name))


async def test_keys_and_titles_fit(language: str, tmp_path: Path) -> None:
    from surveyapp.tui.app import SurveyApp

    text = await seen(SurveyApp(None), ())
    assert languages.translated("Recent projects") in text
    await seen(SurveyApp(None), ("n",))
    await seen(SurveyApp(None), ("p",))
    session = make_project(tmp_path / "ramp-3")
    text = await seen(SurveyApp(str(session)), ("enter",))
    assert languages.translated("sights before") in text
    book = session / "observations" / "r1.csv"
    book.write_text(book_text(simulated(points=12).rows[:17]), encoding="utf-8")
    await seen(SurveyApp(str(session)), ("enter",))  # its footer is the fullest


async def test_results_are_told_and_not_only_menus(language: str, tmp_path: Path) -> None:
    from surveyapp.tui.app import SurveyApp

    folder = own_copy(tmp_path, "tongjin-2015")
    checks = await seen(SurveyApp(folder), ("4",))
    assert languages.translated("NOT MET") in checks
    lines = await seen(SurveyApp(folder), ("2",), (120, 40))
    assert languages.translated("known azimuth") in lines  # a source of the budget
    assert "known azimuth" not in lines
    broken = Path(own_copy(tmp_path, "gi-b1-1966"))
    book = broken / "observations" / "round-3.csv"
    text = book.read_text(encoding="utf-8").replace("107-57-34", "365-57-34")
    book.write_text(text, encoding="utf-8")
    told = await seen(SurveyApp(str(broken)), ())
    assert languages.translated("this project cannot be used as it stands") in told


async def test_another_language_is_remembered_and_begins_anew(
    language: str, tmp_path: Path
) -> None:
    from surveyapp.io.settings import read_settings
    from surveyapp.tui.app import OTHER_LANGUAGE, SurveyApp

    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await pilot.press("l")
        await pilot.pause()
    assert app.return_value == OTHER_LANGUAGE
    codes = list(languages.LANGUAGES)
    following = codes[(codes.index(language) + 1) % len(codes)]
    assert read_settings().language == following
    assert languages.preferred(read_settings().language) == following
