"""Effects of the subject campaign, one physical cause per file."""
