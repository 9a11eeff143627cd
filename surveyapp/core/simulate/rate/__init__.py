"""Simulated logs of rate sensors, made from attitudes and the rotation of the earth."""
