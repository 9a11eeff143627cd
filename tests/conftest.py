"""Tests read English, whatever the locale of the machine: those of languages choose their own.

Linear algebra runs in one thread, set before numpy is loaded: the matrices are small, and threads
that wait for each other double the processor's time of the suite.
"""

from __future__ import annotations

import os

from surveyapp.__main__ import one_thread

os.environ["LANGUAGE"] = "en"
one_thread()
