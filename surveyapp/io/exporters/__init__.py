"""Foreign formats out, one module each."""
