"""Recordings of ROS 2: transforms and poses as observations."""
