"""How far two headings will miss each other: covariance, sections, simulation, placement."""
