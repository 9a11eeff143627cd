"""Tilt sensor forward models."""
