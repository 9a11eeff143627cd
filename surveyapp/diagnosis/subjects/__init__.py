"""What is diagnosed, one file each: how its observations become a problem of the engine."""
