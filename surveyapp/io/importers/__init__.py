"""Foreign formats in, one module each."""
