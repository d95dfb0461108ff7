"""The ``.mcap`` format: camera frames and messages in one file, readable up to a crash."""
