"""A user's own effects: loaded from a named file, and checked before they are used."""
