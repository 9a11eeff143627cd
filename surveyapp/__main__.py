"""``python -m surveyapp``."""

from __future__ import annotations

import io
import sys


def run() -> None:
    """Run the command line and leave with its exit code.

    A character that the terminal's encoding does not have is escaped, never a reason to fail.
    """
    from surveyapp.cli.main import main

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    sys.exit(main(sys.argv[1:]))


if __name__ == "__main__":
    run()
