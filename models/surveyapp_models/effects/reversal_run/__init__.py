"""Effects of the subject reversal_run, one physical cause per file."""
