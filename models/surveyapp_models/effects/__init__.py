"""The catalogue of effects: one physical cause per file."""
