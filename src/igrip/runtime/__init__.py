"""The estimator at work: one loop, the inputs that feed it, the outputs that it sends to."""
