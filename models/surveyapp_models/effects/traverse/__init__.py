"""Effects of the subject traverse, one physical cause per file."""
