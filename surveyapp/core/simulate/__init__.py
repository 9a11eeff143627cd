"""Simulated observations from the integrated equation of motion, with their truth beside them.

It writes no file and shares no basis function with estimation or diagnosis.
"""
