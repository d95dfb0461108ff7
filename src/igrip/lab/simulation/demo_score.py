"""The score of the demo: how often intentions were right at the end of a reach."""

from __future__ import annotations

from typing import Any

from igrip.describe import describe
from igrip.intention import Intention
from igrip.lab.simulation.demo import DemoTask, Moment


class StatusChanges:
    """Describes each change of a hand's status or lease."""

    def __init__(self) -> None:
        self._before: dict[str, tuple[str, str | None]] = {}

    def update(self, intentions: list[Intention]) -> list[str]:
        """Return a line for each change."""
        lines = []
        for intention in intentions:
            lease = intention.commitment.target if intention.commitment else None
            now = (intention.status, lease)
            before = self._before.get(intention.hand)
            self._before[intention.hand] = now
            if before is None or before == now:
                continue
            note = "" if lease is None else f"; a device may act on {lease}"
            if lease is None and before[1] is not None:
                note = f"; the lease on {before[1]} ends"
            lines.append(f"  {intention.t:7.2f} s  {describe(intention)}{note}")
        return lines


class DemoScore:
    """Compares intentions with tasks, one reach at a time.

    A reach counts as right if the last prediction before its end was; the target was found with the
    first of the correct predictions that lasted to the end.
    """

    def __init__(self) -> None:
        self.reaches: list[dict[str, Any]] = []
        self._task: DemoTask | None = None
        self._found: float | None = None
        self._last: Intention | None = None

    def update(self, moment: Moment, intentions: list[Intention]) -> str | None:
        """Add the intentions of one message; return a line of text when a reach has ended."""
        task, t = moment.task, moment.observation.t
        if task is not self._task and t < task.end:
            self._task, self._found, self._last = task, None, None
        if self._task is None:
            return None
        if t > task.end:
            return self._finish()
        for intention in intentions:
            if intention.hand != task.hand or t < task.onset:
                continue
            self._last = intention
            if intention.target != task.target:
                self._found = None
            elif self._found is None:
                self._found = t
        return None

    def _finish(self) -> str | None:
        task, last = self._task, self._last
        self._task = None
        if task is None or last is None:
            return None
        found = None if self._found is None else self._found - task.onset
        movement = task.end - task.onset
        row = {
            "hand": task.hand, "target": task.target, "grip": task.grip,
            "predicted_target": last.target, "predicted_grip": last.grip,
            "target_right": last.target == task.target, "grip_right": last.grip == task.grip,
            "found_after_s": found, "movement_s": movement,
        }  # fmt: skip
        self.reaches.append(row)
        mark = "✓" if row["target_right"] and row["grip_right"] else "✗"
        when = "" if found is None else f", found after {found:.2f} of {movement:.2f} s"
        return (
            f"{mark} {task.hand} hand to {task.target}, {task.grip}: "
            f"predicted {last.target}, {last.grip}{when}"
        )

    def summary(self) -> dict[str, Any]:
        """Return the counts, and each reach, as plain data."""
        found = [r["found_after_s"] / r["movement_s"] for r in self.reaches if r["target_right"]]
        return {
            "reaches": len(self.reaches),
            "targets_right": sum(r["target_right"] for r in self.reaches),
            "grips_right": sum(r["grip_right"] for r in self.reaches),
            "found_at_part_of_movement": sum(found) / len(found) if found else None,
            "each": self.reaches,
        }

    def sentence(self) -> str:
        """Return the counts in one sentence."""
        s = self.summary()
        if not s["reaches"]:
            return "no reach has ended yet"
        part = s["found_at_part_of_movement"]
        when = (
            ""
            if part is None
            else f"; final correct prediction at {part:.0%} of the movement on average"
        )
        return (
            f"{s['reaches']} reaches: {s['targets_right']} targets and {s['grips_right']} grips "
            f"right at the end{when}"
        )
