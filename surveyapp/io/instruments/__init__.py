"""Total stations on the cable: one module for each protocol; ``catalogue`` lists them.

Written from public manuals and tested against simulated instruments: no real one was at hand.
"""
