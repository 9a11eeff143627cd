"""Distributions and tests, exact and without scipy, so that ``orient`` starts at once."""
