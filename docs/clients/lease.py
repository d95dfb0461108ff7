"""The client's rule for leases: may a device start an action now? Copy it into your program."""

import time


class Lease:
    """Feed it every message of one hand; ask it before acting, and while a closing goes on."""

    def __init__(self, clock=time.monotonic):
        self.clock, self.session, self.seq, self.until = clock, None, 0, 0.0

    def take(self, message):
        """Take a message as it came."""
        if message["session"] == self.session and message["seq"] <= self.seq:
            return  # late, or told twice
        self.session, self.seq = message["session"], message["seq"]
        granted = message["commitment"] is not None and message["valid_for"] is not None
        self.until = self.clock() + min(message["valid_for"], 0.15) if granted else 0.0

    def permits(self):
        """Say whether to act now."""
        return self.clock() < self.until
