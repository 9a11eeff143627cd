"""Traverse books and their tables in project.toml, read into a network."""
