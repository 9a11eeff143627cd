"""``[penetration]`` of project.toml, and what the traverses of its headings have observed."""
