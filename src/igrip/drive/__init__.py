"""From intentions to a device: the receiver of leases, the supervisor, the user's say."""
