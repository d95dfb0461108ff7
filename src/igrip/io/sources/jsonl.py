"""Observations from a ``.jsonl`` file."""

from igrip.io.recordings.jsonl import JsonlReader
from igrip.io.sources import SOURCES

SOURCES.register("jsonl")(JsonlReader)
