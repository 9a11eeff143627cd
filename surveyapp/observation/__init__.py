"""What serves the screens while a surveyor observes: one reading at a time, doubts, practice."""
