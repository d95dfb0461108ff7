"""How fast the estimator is here, beside peers that do the same work, measured in one run."""
