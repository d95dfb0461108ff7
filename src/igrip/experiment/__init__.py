"""Experiments with people: a study file, a plan, a journal of what happened, and screens."""
