"""The client's rule for leases: may a device start an action now? Copy it into your program."""

import time


class Lease:
    """Update it with every message of one hand; ask it before acting, and during a closing."""

    def __init__(self, clock=time.monotonic):
        self.clock, self.session, self.seq, self.min_delay, self.until = clock, None, 0, 0.0, 0.0

    def update(self, message):
        """Process a message at the moment of its receipt."""
        if "session" not in message or (
            message["session"] == self.session and message["seq"] <= self.seq
        ):
            return  # not an intention, or late, or a duplicate
        delay, now = self.clock() - message["sent"], self.clock()
        same = message["session"] == self.session
        self.min_delay = min(self.min_delay, delay) if same else delay
        self.session, self.seq = message["session"], message["seq"]
        valid_for = message["valid_for"] if message["commitment"] else None
        self.until = now + min(valid_for, 0.15) - (delay - self.min_delay) if valid_for else 0.0

    def permits(self):
        """Return whether a device may act now."""
        return self.clock() < self.until
