"""Benchmarks that stay outside the wheel: ``python -m benchmarks``, ``.startup``, ``.tree``."""
