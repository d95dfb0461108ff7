"""The estimator as a service: what comes in is stamped and bounded, what goes out never waits."""
