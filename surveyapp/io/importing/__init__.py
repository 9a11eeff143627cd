"""Field files into a project: what will be written, and one writing of all of it."""
