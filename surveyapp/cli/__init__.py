"""The command line: one command a file; results to stdout, diagnostics to stderr."""
