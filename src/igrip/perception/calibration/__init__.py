"""Where cameras stand, and their lenses."""
