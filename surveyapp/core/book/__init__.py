"""Rules of the field book: sides of turning points, strikes, and how finely it was read."""
