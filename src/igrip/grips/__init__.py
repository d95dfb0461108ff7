"""Selectors of the grip, found by name."""

from igrip.grips.base import GRIPS, Grip, GripConfig, GripSelector

__all__ = ["GRIPS", "Grip", "GripConfig", "GripSelector"]
