"""Themes: dark for underground, light for the office, high contrast for a bad screen or bad eyes.

NO_COLOR is honoured by textual itself; nothing in the screens is told by colour alone.
"""

from __future__ import annotations

from typing import Final

from textual.theme import Theme

DARK: Final = Theme(
    name="survey-dark",
    primary="#5fafd7",
    secondary="#87afaf",
    accent="#ffd75f",
    warning="#ffaf00",
    error="#ff5f5f",
    success="#87d787",
    foreground="#d0d0d0",
    background="#101010",
    surface="#181818",
    panel="#262626",
    dark=True,
)
LIGHT: Final = Theme(
    name="survey-light",
    primary="#005f87",
    secondary="#3a6060",
    accent="#8a5a00",
    warning="#8a5a00",
    error="#a00000",
    success="#006000",
    foreground="#1c1c1c",
    background="#ffffff",
    surface="#f4f4f4",
    panel="#e0e0e0",
    dark=False,
)
CONTRAST: Final = Theme(
    name="survey-contrast",
    primary="#ffffff",
    secondary="#ffffff",
    accent="#ffff00",
    warning="#ffff00",
    error="#ffffff",
    success="#ffffff",
    foreground="#ffffff",
    background="#000000",
    surface="#000000",
    panel="#000000",
    dark=True,
    variables={
        "text-muted": "#ffffff",
        "text-disabled": "#ffffff",
        "footer-key-foreground": "#ffff00",
        "block-cursor-background": "#ffff00",
        "block-cursor-foreground": "#000000",
        "border": "#ffffff",
    },
)
THEMES: Final = (DARK, LIGHT, CONTRAST)
