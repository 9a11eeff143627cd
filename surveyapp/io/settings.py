"""What the screens remember of a user: recent projects, theme, sound. Never anything of a survey.

A settings file that cannot be read or written is no reason to stop a surveyor: the defaults hold.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from surveyapp.errors import SurveyError
from surveyapp.io.locations import user_config_folder
from surveyapp.io.tomltext import atomic_write, toml_value

SETTINGS_FILE: Final = "screens.toml"
REMEMBERED: Final = 12


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of the screens.

    Parameters
    ----------
    recent : tuple of str
        Project folders, the latest first.
    theme : str
        Name of a theme, empty for the default.
    sound : bool
        Whether the countdown may be heard.
    instrument : str
        Total station on the cable, ``protocol:port``; empty where there is none.
    language : str
        Code of the language of screens and record; empty: that of the locale.
    """

    recent: tuple[str, ...] = ()
    theme: str = ""
    sound: bool = True
    instrument: str = ""
    language: str = ""

    def with_recent(self, folder: str) -> Settings:
        """The same with a project at the top of the recent ones."""
        others = tuple(item for item in self.recent if item != folder)
        return replace(self, recent=(folder, *others)[:REMEMBERED])


def read_settings(folder: Path | None = None) -> Settings:
    """Read the user's settings; the defaults where there are none or where they make no sense."""
    path = (folder or user_config_folder()) / SETTINGS_FILE
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return Settings()
    recent = data.get("recent", [])
    theme, sound = data.get("theme", ""), data.get("sound", True)
    instrument, language = data.get("instrument", ""), data.get("language", "")
    return Settings(
        recent=tuple(item for item in recent if isinstance(item, str))
        if isinstance(recent, list)
        else (),
        theme=theme if isinstance(theme, str) else "",
        sound=sound if isinstance(sound, bool) else True,
        instrument=instrument if isinstance(instrument, str) else "",
        language=language if isinstance(language, str) else "",
    )


def write_settings(settings: Settings, folder: Path | None = None) -> bool:
    """Write the user's settings; False where that is not possible."""
    place = folder or user_config_folder()
    text = "# surveyapp: settings of the screens\n"
    text += f"theme = {toml_value(settings.theme)}\n"
    text += f"sound = {toml_value(settings.sound)}\n"
    text += f"language = {toml_value(settings.language)}\n"
    text += f"instrument = {toml_value(settings.instrument)}\n"
    text += f"recent = {toml_value(list(settings.recent))}\n"
    try:
        place.mkdir(parents=True, exist_ok=True)
        atomic_write(place / SETTINGS_FILE, text.encode("utf-8"))
    except (OSError, SurveyError):
        return False
    return True
