"""What scripts call: the same functions as the command line, on values instead of text."""
