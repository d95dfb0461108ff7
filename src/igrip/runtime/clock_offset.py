"""The offset of a sender's clock from this machine's, with its drift and its steps.

The delay of a message, arrival minus the sender's time, is the offset plus a time on the way that
is never negative. So the offset is the lower envelope of the delays: the minimum filter of NTP
(Mills 1991, IEEE Transactions on Communications 39(10)), which here may rise as fast as clocks
drift; the drift is the Theil-Sen slope of the minima of blocks (after Moon, Skelly & Towsley 1999,
INFOCOM). A delay that grows is age, however long it lasts: it cannot be distinguished from the way
of the message. A clock that was set shows in the sender's own intervals, which are irregular where
those of arrival are not; as in NTP, the new time is believed only after several messages agree on
it.
"""

from __future__ import annotations

import math
from collections import Counter, deque
from typing import Any

from igrip.runtime.clock_drift import DriftEstimate
from igrip.runtime.clock_step import (
    Kind,
    StepCandidate,
    TimedMessage,
    format_seconds,
    missing_interval,
)

INTERVALS = (4, 32)  # of the sender that its period needs, and that are kept
RESIDUALS = 64  # delays above the offset that are kept: how much the way varies
RECENT = 8  # of them that a new one is compared with
MIN_STEP = 0.025  # s; a smaller step back is left as age
MIN_FORWARD = 0.05  # s; a smaller step ahead is believed at once
MIN_LATE = 0.1  # s; after a pause, a smaller delay is left as age
PAUSE = 1.0  # s of silence, by both clocks, after which a constant delay may be another clock
RATE = 100.0  # times of another unit run at least so much faster or slower than arrivals
RATE_SPAN = 0.25  # s of arrivals that show it


class ClockOffset:
    """The offset of one sender's clock from that of the run.

    Parameters
    ----------
    name : str
        Of the sender, for texts.

    Attributes
    ----------
    distrust : str or None
        Why the ages of its messages are not known at present; None: they are.
    event : str or None
        What was done about its clock last.
    counts : Counter
        How many ``steps`` of the clock were followed, and how many messages were ``outliers``.
    """

    def __init__(self, name: str = "a sender") -> None:
        self.name = name
        self.distrust: str | None = None
        self.event: str | None = None
        self.counts: Counter[str] = Counter()
        self._offset = math.nan
        self._last = TimedMessage(math.nan, math.nan)
        self._candidate: StepCandidate | None = None
        self._intervals: deque[float] = deque(maxlen=INTERVALS[1])
        self._residuals: deque[float] = deque(maxlen=RESIDUALS)
        self._drift = DriftEstimate()
        self._begin_rate()

    @property
    def drift(self) -> float | None:
        """How much faster than this machine's clock the sender's runs [s/s]; None: not known."""
        return None if self._drift.slope is None else -self._drift.slope

    def report(self) -> dict[str, Any]:
        """Return offset, drift, counts and what was done last, as plain data."""
        return {
            "offset": None if math.isnan(self._offset) else round(self._offset, 6),
            "drift_ppm": None if self.drift is None else round(1e6 * self.drift, 1),
            "followed": self.distrust is None, "reason": self.distrust, "event": self.event,
            **self.counts,
        }  # fmt: skip

    def update(self, sent: float, arrived: float) -> float:
        """Return the offset after a message [s].

        While :attr:`distrust` is not None it is that of before, by which a message of a clock that
        was set back looks older than it is.
        """
        message = TimedMessage(sent, arrived)
        if math.isnan(self._offset):
            self._offset, self._last = message.delay, message
            return self._offset
        passed = max(0.0, arrived - self._last.arrived)
        self._offset += passed * self._drift.max_rise
        if self._candidate is None:
            self._candidate = self._find_candidate(message)
            if self._candidate is None:
                self._follow(message)
            else:
                self.distrust = self._candidate.describe(self.name)
        else:
            self._weigh(self._candidate, message)
        self._last = message
        return self._offset

    def note_step(self, seconds: float, place: str) -> None:
        """Note that times stepped, back if negative, and were followed from there."""
        self.counts["steps"] += 1
        direction = "ahead" if seconds > 0.0 else "back"
        size = format_seconds(abs(seconds))
        self.event = f"the clock of {self.name} stepped {direction} by {size} {place}; followed"

    def note_gap(self, seconds: float, place: str) -> None:
        """Note that nothing was measured for some time."""
        self.counts["gaps"] += 1
        self.event = f"{self.name}: nothing for {format_seconds(seconds)} {place}"

    def _follow(self, message: TimedMessage) -> None:
        """Take a message of the followed clock."""
        interval = message.sent - self._last.sent
        if interval > 0.0:
            self._intervals.append(interval)
        self._offset = min(self._offset, message.delay)
        self._residuals.append(message.delay - self._offset)
        self._drift.add(message.arrived, message.delay)
        self._check_rate(interval, message.arrived - self._last.arrived)

    def _find_candidate(self, message: TimedMessage) -> StepCandidate | None:
        """Return the beginning of another clock, if the sender's own interval shows one."""
        shift = message.delay - self._offset
        interval = message.sent - self._last.sent
        period, spread = self._period()
        # what the way alone may vary by is believed at once
        ahead = max(MIN_FORWARD, max(self._residuals, default=0.0))
        if shift < -ahead and period is not None and interval >= 1.5 * period:
            if interval - (message.arrived - self._last.arrived) >= MIN_FORWARD:
                return StepCandidate("ahead", message, -shift, shift)
            return None
        before = min(list(self._residuals)[-RECENT:], default=0.0)
        missing = missing_interval(interval, period, spread) or self._below_all(interval)
        if missing >= MIN_STEP and shift - before >= 0.5 * missing:
            return StepCandidate("back", message, missing, shift)
        if interval >= max(PAUSE, 5.0 * (period or 0.0)) and shift - before >= MIN_LATE:
            return StepCandidate("pause", message, shift, shift)
        return None

    def _weigh(self, candidate: StepCandidate, message: TimedMessage) -> None:
        """Compare a message with the followed clock and with the one that may be new."""
        shift = message.delay - self._offset
        if candidate.returned(shift):
            self.counts["outliers"] += len(candidate.messages)
            if candidate.kind != "pause":
                off = f"{candidate.shift:+.3g} s"
                self.event = f"{self.name}: a time that was off by {off} was left out"
            self._candidate = self.distrust = None
            self._last = message._replace(sent=math.nan)  # the interval is that of an outlier
            self._follow(message)
            return
        again = self._breaks(candidate, message)
        if again is not None:
            again.begin = candidate.begin
            self._candidate, self.distrust = again, again.describe(self.name)
            return
        candidate.add(message)
        if candidate.agrees():
            self._relock(candidate, message)

    def _breaks(self, candidate: StepCandidate, message: TimedMessage) -> StepCandidate | None:
        """Return a candidate of its own if a message belongs to neither clock."""
        newest = candidate.messages[-1]
        interval = message.sent - newest.sent
        period, spread = self._period()
        shift = message.delay - self._offset
        kind: Kind = "back" if shift > 0.0 else "ahead"
        ahead = candidate.lowest_delay - message.delay
        if ahead >= MIN_FORWARD and period is not None and interval >= 1.5 * period + MIN_FORWARD:
            return StepCandidate(kind, message, abs(shift), shift)
        if (
            missing_interval(interval, period, spread) >= MIN_STEP
            and message.delay - newest.delay > 0.0
        ):
            return StepCandidate(kind, message, abs(shift), shift)
        return None

    def _relock(self, candidate: StepCandidate, message: TimedMessage) -> None:
        offset = candidate.offset(self._residuals)
        step = self._offset - offset  # of the sender's clock
        direction = "ahead" if step > 0.0 else "back"
        after = message.arrived - candidate.begin
        self.event = (
            f"the clock of {self.name} stepped {direction} by {format_seconds(abs(step))}; it is "
            f"followed again after {after:.2f} s"
        )
        self.counts["steps"] += 1
        self._offset = offset
        self._candidate = self.distrust = None
        self._drift = DriftEstimate()
        self._begin_rate()

    def _period(self) -> tuple[float | None, float]:
        """Return the sender's usual interval, None if it is not known, and its usual deviation."""
        if len(self._intervals) < INTERVALS[0]:
            return None, 0.0
        steps = sorted(self._intervals)
        # of many lost messages the intervals are multiples: the lower quartile is the period
        period = steps[len(steps) // 4]
        off = sorted(abs(step - period * max(1, round(step / period))) for step in steps)
        return period, off[len(off) // 2]

    def _below_all(self, interval: float) -> float:
        """Return by how much an interval is shorter than all others [s]; 0: it is not by far.

        Of an irregular sender it is the only sign of a step back by about one period.
        """
        least = min(self._intervals, default=0.0)
        many = len(self._intervals) >= INTERVALS[1] // 2
        return least - interval if many and interval < 0.5 * least else 0.0

    def _begin_rate(self) -> None:
        self._sent_span = self._arrived_span = 0.0
        self._rated = 0

    def _check_rate(self, sent: float, arrived: float) -> None:
        """Compare the pace of the sender's times with that of arrivals, which shows their unit."""
        if not sent > 0.0:
            return
        self._sent_span += sent
        self._arrived_span += arrived
        self._rated += 1
        if self._rated < INTERVALS[0] or self._arrived_span < RATE_SPAN:
            return
        rate = self._sent_span / self._arrived_span
        self.distrust = None
        if not 1.0 / RATE < rate < RATE:
            self.distrust = self.event = (
                f"the times of {self.name} run {rate:.3g} times as fast as they arrive"
                f"{_unit_question(rate)}"
            )
        self._begin_rate()


def _unit_question(rate: float) -> str:
    for unit, size in (("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
        if 0.5 < rate / size < 2.0:
            return f": are they {unit} (--time-unit {unit})?"
    return ": is their unit the second (--time-unit)?"
