"""The paper's evaluation of any dataset.

The files, in the order of the data:

- ``runner``: runs estimators over the recordings of a dataset, in several processes.
- ``recorded_trial``: what one recording holds of its trial, without any estimator.
- ``movement``: onset and end of the movement in it.
- ``trial_description``: task, validity and layout of the trial, from these.
- ``trials``: the rules for one sequence of predictions: success, delay, margin, detection.
- ``trial_metrics``: the numbers of one estimator in one trial, by these rules.
- ``predicted_times``: when the hand was at its target, and how well that was predicted.
- ``commitments``, ``calibration``: when leases would begin; whether probabilities hold.
- ``trial_rows``: a trial as rows of the table, one per estimator, out of all of the above.
- ``averages``, ``summary``: rows to means, Table I, and ``summary.json``.
- ``evaluation``, ``fingerprint``: the rows of ``igrip evaluate`` on disk, resumed while valid.
- ``replay``: the same numbers for ``igrip replay``, in memory.
- ``time_courses``: Figure 6 of one hand.
"""
