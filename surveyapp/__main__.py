"""``python -m surveyapp``."""

from __future__ import annotations

import io
import os
import sys


def one_thread() -> None:
    """Let linear algebra run in one thread, unless the surroundings say otherwise.

    To be called before numpy is loaded. Matrices are small here: the threads of a library cost
    more than they give, and those of the processes of a pool stand in each other's way.
    """
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def run() -> None:
    """Run the command line and leave with its exit code.

    A character that the terminal's encoding does not have is escaped, never a reason to fail.
    """
    one_thread()
    from surveyapp.cli.main import main

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    sys.exit(main(sys.argv[1:]))


if __name__ == "__main__":
    run()
