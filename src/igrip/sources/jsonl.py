"""Observations from a ``.jsonl`` file."""

from igrip.recording.jsonl import JsonlReader
from igrip.sources.base import SOURCES

SOURCES.register(".jsonl")(JsonlReader)
