"""A model of one's own thing, from turning it before a camera with depth."""
