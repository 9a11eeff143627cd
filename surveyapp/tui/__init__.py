"""The terminal screens; all numbers come from surveyapp.api."""
