"""Find the residual, name the effect, prove it."""
