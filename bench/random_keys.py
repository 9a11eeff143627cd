"""``python -m bench random_keys``: sessions worked by random keystrokes, by default 2000."""

from __future__ import annotations

import asyncio
import os
import sys
import tempfile
from pathlib import Path

from tests.tui.random_keys import random_session


def main(arguments: list[str]) -> int:
    """Run the campaign; an argument gives the number of sessions."""
    count = int(arguments[0]) if arguments else 2000
    os.environ["TEXTUAL_ANIMATIONS"] = "none"
    faults = 0
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CONFIG_HOME"] = folder
        for seed in range(count):
            try:
                asyncio.run(random_session(Path(folder) / f"s{seed}", seed, keys=60))
            except AssertionError as error:
                faults += 1
                print(f"seed {seed}: {error}", file=sys.stderr)
    print(f"{count} sessions of random keys: {faults} with a fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
