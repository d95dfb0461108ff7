"""Rays and distances between hands and meshes: one compiled kernel over static trees."""
