"""Recordings as files: ``.jsonl`` and ``.mcap``."""
