"""Measurements of igrip outside the wheel: ``python -m benchmarks``, ``.startup``, ``.tree``."""
