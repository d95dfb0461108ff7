"""Simulated people, sensors and faults."""
