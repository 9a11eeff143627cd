"""One session's swing to gyro north: turning points, passages, rounds, tape zero and sights."""
