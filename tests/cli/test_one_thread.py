"""Linear algebra of the command runs in one thread; whoever sets another number keeps it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

SHOW = (
    "import os, sys; sys.argv = ['surveyapp', '--version']; from surveyapp.__main__ import run\n"
    "try: run()\nexcept SystemExit: print(os.environ['OPENBLAS_NUM_THREADS'])"
)


@pytest.mark.parametrize(("given", "used"), [(None, "1"), ("4", "4")])
def test_one_thread_unless_another_number_is_set(given: str | None, used: str) -> None:
    surroundings = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"}
    surroundings |= {"OPENBLAS_NUM_THREADS": given} if given else {}
    done = subprocess.run(
        [sys.executable, "-c", SHOW], env=surroundings, capture_output=True, text=True, check=True
    )
    assert done.stdout.split()[-1] == used
