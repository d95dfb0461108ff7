"""Pose finders: from a frame to the poses of the catalogue's objects, found by name."""
