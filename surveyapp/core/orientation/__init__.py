"""Sessions to instrument constants to oriented lines."""
