"""The client's rule for leases: may a device start an action now? Copy it into your program."""

import time


class Lease:
    """Feed it every message of one hand; ask it before acting, and while a closing goes on."""

    def __init__(self, clock=time.monotonic):
        self.clock, self.session, self.seq, self.least, self.until = clock, None, 0, 0.0, 0.0

    def take(self, message):
        """Take a message as it came."""
        if "session" not in message or (
            message["session"] == self.session and message["seq"] <= self.seq
        ):
            return  # no intention, or late, or told twice
        way, now = self.clock() - message["sent"], self.clock()
        self.least = min(self.least, way) if message["session"] == self.session else way
        self.session, self.seq = message["session"], message["seq"]
        valid_for = message["valid_for"] if message["commitment"] else None
        self.until = now + min(valid_for, 0.15) - (way - self.least) if valid_for else 0.0

    def permits(self):
        """Say whether to act now."""
        return self.clock() < self.until
