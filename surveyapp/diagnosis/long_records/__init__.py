"""Records too long to be diagnosed whole: spectral lines, then block means."""
