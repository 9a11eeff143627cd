"""Estimation from sensor logs: compass, tilt sensor, Allan deviation, filters."""
