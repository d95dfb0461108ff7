"""A certificate for this machine: latencies, and how long a device takes to stop after faults."""
