"""Benchmarks and measurements outside the wheel, each run as ``python -m benchmarks[.NAME]``."""
