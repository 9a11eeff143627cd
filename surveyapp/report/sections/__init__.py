"""Sections of the survey record, one a file: results in, plain blocks out."""
