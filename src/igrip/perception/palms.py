"""From a detected hand to its palm in the world, where depth was measured on it."""

from igrip.perception.hands._palms import DEFAULT, PalmConfig, measure_palm

__all__ = ["DEFAULT", "PalmConfig", "measure_palm"]
