"""Camera, hands and objects, each at its own rate, to one stream of observations."""
