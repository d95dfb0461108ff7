"""Measurements of igrip, outside the wheel."""
