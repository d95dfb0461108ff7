"""How fast the estimator is on this machine, beside other ray engines in the same run."""
