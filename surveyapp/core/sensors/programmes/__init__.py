"""Guided programmes: steps as values, what a run has determined so far, which step is next."""
