"""Pointings of a field file to sets, means of the faces and sigmas."""
