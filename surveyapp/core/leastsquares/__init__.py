"""Least squares for whitened, sparse linear systems: solution, rank, needed parts of the inverse.

Knows nothing of points, angles or surveying: unknowns are numbers, equations are arrays.
"""
