"""What the screens remember for a user: theme, sound, language."""

from __future__ import annotations

from dataclasses import replace

from surveyapp.io.settings import Settings, read_settings, write_settings


def keep_theme(theme: str) -> None:
    """Remember the theme."""
    write_settings(replace(read_settings(), theme=theme))


def keep_sound(*, sound: bool) -> Settings:
    """Remember whether the countdown may be heard."""
    settings = replace(read_settings(), sound=sound)
    write_settings(settings)
    return settings


def keep_language(language: str) -> bool:
    """Remember the language of screens and record; False where that is not possible."""
    return write_settings(replace(read_settings(), language=language))
