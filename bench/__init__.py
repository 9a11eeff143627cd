"""Benchmarks: ratios against a peer in the same run, and the full Monte Carlo campaigns."""

from surveyapp.__main__ import one_thread

one_thread()  # before a benchmark loads numpy, as the command does
