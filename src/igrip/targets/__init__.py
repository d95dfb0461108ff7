"""Estimators of the target, found by name; one instance follows one hand."""

from igrip.targets.base import TARGETS, Belief, TargetsEstimator, best_of

__all__ = ["TARGETS", "Belief", "TargetsEstimator", "best_of"]
