"""Real reaches to grasp: how early the grip class and the opening show."""

from __future__ import annotations

from pathlib import Path


def print_sizes(folder: Path) -> None:
    """Print."""


def print_depths(folder: Path) -> None:
    """Print."""
