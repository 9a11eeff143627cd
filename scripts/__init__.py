"""Committed scripts that make documentation and pictures."""
