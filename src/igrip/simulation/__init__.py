"""Simulated people and sensors."""
