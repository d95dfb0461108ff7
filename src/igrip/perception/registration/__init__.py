"""Meshes fitted to depth pictures."""
