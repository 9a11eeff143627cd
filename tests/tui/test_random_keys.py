"""Random keystrokes: no confirmed row lost, altered or doubled, no book that a reader refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.tui.random_keys import random_session


@pytest.mark.parametrize("seed", range(4))
async def test_any_keys_leave_a_book_that_every_command_reads(tmp_path: Path, seed: int) -> None:
    await random_session(tmp_path / "p", seed, keys=45)
