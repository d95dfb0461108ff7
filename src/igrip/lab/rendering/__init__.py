"""Rendered depth pictures of meshes on a table."""
