"""The experiment: simulation, evaluation, report."""
