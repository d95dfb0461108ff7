"""Observations from an ``.mcap`` file."""

from igrip.io.recordings.mcap_writer import McapReader
from igrip.io.sources import SOURCES

SOURCES.register("mcap")(McapReader)
