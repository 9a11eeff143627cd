"""Frozen values that every layer above understands: readings, sessions, stations, results.

Angles in radians, lengths in metres, times in seconds, temperatures in degrees Celsius. Nothing in
this package computes more than what a value says about itself.
"""
