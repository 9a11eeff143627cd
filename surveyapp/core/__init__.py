"""Estimation on values: no files, no clock, no randomness of its own."""
