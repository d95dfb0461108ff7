"""Bags of ROS 2 as folders, which can only be read; named ``ros2:FOLDER`` or by their metadata."""

from igrip.io.recordings import SOURCES, RecordingFormat
from igrip.io.ros2.bag_reader import BagReader

SOURCES.register("ros2")(RecordingFormat(BagReader))
