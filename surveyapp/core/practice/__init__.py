"""The simulated instrument of the practice mode."""
