"""Fibre-optic and micro-mechanical rate sensors: calibration, north finding, state of motion."""
