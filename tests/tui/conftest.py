"""Screens in tests: settings in a folder of their own, no colour, no motion."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual import _wait


@pytest.fixture(autouse=True)
def own_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("TEXTUAL_ANIMATIONS", "none")
    monkeypatch.delenv("NO_COLOR", raising=False)


@pytest.fixture(autouse=True)
def short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    """After each key the pilot looks twice whether the processor is idle: for 5 ms, not for 20."""
    monkeypatch.setattr(_wait, "SLEEP_GRANULARITY", 1.0 / 200.0)
    monkeypatch.setattr(_wait, "SLEEP_IDLE", 1.0 / 4000.0)
