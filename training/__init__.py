"""How the numbers of the learned estimators are made: ``python -m training --help``."""
