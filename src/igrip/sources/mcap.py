"""Observations from an ``.mcap`` file."""

from igrip.recording.mcap import McapReader
from igrip.sources.base import SOURCES

SOURCES.register(".mcap")(McapReader)
