"""A session with nobody there: every trial is started and stopped by itself."""

from __future__ import annotations

from collections.abc import Iterator

from igrip.experiment.session import Session


def run_unattended(session: Session) -> Iterator[tuple[int, int]]:
    """Do all trials that are left; yield how many are done, and of how many."""
    while session.next_trial is not None:
        if session.status()["break_due"]:
            session.end_break()
        session.start()
        session.stop()
        yield len(session.progress.done), len(session.plan.trials)
