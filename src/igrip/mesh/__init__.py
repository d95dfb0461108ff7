"""Meshes alone: trees, rays, nearest points, inscribed spheres."""
