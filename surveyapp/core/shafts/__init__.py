"""Orientation through shafts: swinging wires, triangles, two shafts, wires joined with gyro."""
