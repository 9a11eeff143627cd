"""``[[shaft]]`` of project.toml and its book."""
