"""What all devices share: the protocol, limits, settings, ramps, ports and the base of twins."""
