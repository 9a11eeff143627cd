"""The suspended gyro: moments, periods and coefficients against latitude; its motion."""
