"""Diagnosis of sensor logs: many rows of several channels, with correlated noise as a rival."""
