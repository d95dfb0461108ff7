"""Configurations for one person, or for people like those of a cohort.

The files, in the order of the data:

- ``space``: which numbers are tuned, and between which bounds.
- ``replays``: the trials replayed once to the evidence of commitments.
- ``outcomes``: what a configuration makes of that evidence, trial by trial.
- ``objective``: the value of such outcomes.
- ``split``: folds by trial, or by participant.
- ``search``: one Optuna study for a set of trials, kept in SQLite.
- ``tuning``: outer folds that judge, the choice, and whether it is worth it.
- ``front``: from reactive to reliable, for a person to pick from.
- ``files``, ``page``: what is written.
"""
