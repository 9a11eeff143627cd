"""Whether a result may be believed: tests that need no rule book, as functions of values."""
