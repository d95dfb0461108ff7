"""The estimator at work: the loop, its inputs and its outputs."""
