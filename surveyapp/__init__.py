"""Gyro-theodolite orientation for mine surveying: what is done with observations.

Scripts import ``surveyapp.api``.
"""

__version__ = "0.1.0"
