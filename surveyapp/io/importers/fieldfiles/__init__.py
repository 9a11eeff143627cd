"""Field files of other programs, one module for each format; ``catalogue`` lists them."""
