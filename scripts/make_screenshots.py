"""Pictures of the screens from the samples, for README and docs: docs/images/screen-*.svg.

Usage: python -m scripts.make_screenshots
"""

from __future__ import annotations

import asyncio
import os
import shutil
import tempfile
from datetime import UTC, datetime, timedelta
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
BEGIN = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)
PICTURES: tuple[tuple[str, str | None, tuple[str, ...], tuple[int, int]], ...] = (
    ("screen-home", None, (), (80, 24)),
    ("screen-line", "tongjin-2015", ("2",), (80, 24)),
    ("screen-constants", "tongjin-2015", ("3",), (80, 24)),
    ("screen-run", "johannesburg-1966", ("o",), (100, 32)),
    ("screen-help", "johannesburg-1966", ("o", "f1"), (80, 24)),
    ("screen-result", "gi-b1-1966", ("o", *["f8"] * 4), (80, 24)),
    ("screen-new-project", None, ("n",), (80, 24)),
)
"""Name, sample, keys, size."""


async def picture(folder: str | None, keys: tuple[str, ...], size: tuple[int, int]) -> str:
    """One screen as SVG, with a clock that stands still."""
    from surveyapp.tui.app import SurveyApp

    app = SurveyApp(folder, now=lambda: BEGIN + timedelta(seconds=1), steady=lambda: 1.0)
    async with app.run_test(size=size) as pilot:
        for key in ("", *keys, "", ""):
            await app.workers.wait_for_complete()
            await pilot.pause()
            if key:
                await pilot.press(key)
        await app.workers.wait_for_complete()
        await pilot.pause()
        return app.export_screenshot()


def main() -> None:
    """Write every picture."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        os.environ["XDG_CONFIG_HOME"] = str(Path(place) / "config")
        for number, (name, sample, keys, size) in enumerate(PICTURES):
            folder = None
            if sample is not None:
                folder = str(Path(place) / str(number) / sample)
                shutil.copytree(ROOT / "projects" / sample, folder)
            elif name == "screen-home":
                shutil.rmtree(Path(place) / "config", ignore_errors=True)
            svg = asyncio.run(picture(folder, keys, size))
            text = "\n".join(line.rstrip() for line in svg.splitlines()) + "\n"
            (IMAGES / f"{name}.svg").write_text(text, encoding="utf-8")
            print(f"written docs/images/{name}.svg")


if __name__ == "__main__":
    main()
