"""Benchmarks: ratios against a peer in the same run, and the full Monte Carlo campaigns."""
