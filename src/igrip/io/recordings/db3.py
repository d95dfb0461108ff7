"""Bags of ROS 2 as single files of SQLite, which can only be read."""

from igrip.io.recordings import SOURCES, RecordingFormat
from igrip.io.ros2.bag_reader import BagReader

SOURCES.register("db3")(RecordingFormat(BagReader))
