"""Sensor logs: files of numbers from compasses, tilt sensors, gyros and accelerometers."""
