"""Recordings of messages, and datasets of recordings."""
