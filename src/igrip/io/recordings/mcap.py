"""Recordings as ``.mcap``; the parts of the format are in :mod:`igrip.io.mcap`."""

from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.writer import McapWriter
from igrip.io.recordings import SOURCES, RecordingFormat

SOURCES.register("mcap")(RecordingFormat(McapReader, McapWriter))
