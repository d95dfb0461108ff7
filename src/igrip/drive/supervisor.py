"""The supervisor: the only part that lets a device act, and the one that stops it.

It guarantees, as long as :meth:`Supervisor.step` is called every few milliseconds: no action
without a lease that is valid at that moment, none after its end, none twice on one decision, none
after a veto, a stop or a fault until that is over. It holds no thread and reads time only from its
clock, so that tests run it on a virtual one.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable
from typing import Any, Literal

from igrip.devices.base.device import (
    Cause,
    Condition,
    Device,
    DeviceState,
    Permit,
    Phase,
)  # fmt: skip
from igrip.drive.receiver import Decision

MARGIN = 0.03  # s before the end of a lease at which it stops: a command may take that long
VETO_HOLD = 0.5  # s without a lease after a veto, at least
STOP_RETRY = 0.02  # s
POLL_INTERVAL = 0.02  # s between two looks at a device's state
KEEP_ALIVE_INTERVAL = 0.4  # s
MAX_EVENTS = 512
BLIND = ("warming_up", "lost", "invalid", "holding")  # without a lease, these are no release

Say = Literal["veto", "confirm", "opened"]


class Supervisor:
    """Decides for each moment whether the device acts.

    Parameters
    ----------
    device : Device
        Open.
    grips : collection of str
        The grips that it can do.
    clock : function
        A monotonic clock [s].
    close_before : float
        It closes from this time before the predicted contact on [s].
    say : function, optional
        Called with what the estimator is to be told: ``veto``, ``confirm``, ``opened``.
    margin : float
        It stops this long before the end of a lease [s].
    grip_for : function, optional
        Which of its grips the device does when one is asked for; None: it refuses. By default it
        does those that it can.

    Attributes
    ----------
    acting : Permit or None
        What the device does now.
    events : deque of (float, str)
        What happened, newest last.
    counts : Counter
        ``permits``, ``starts``, ``stops``, ``refused``, and causes of stops.
    """

    def __init__(
        self, device: Device, grips: tuple[str, ...], clock: Callable[[], float],
        close_before: float = 0.3, say: Callable[[Say], None] = lambda say: None,
        margin: float = MARGIN, grip_for: Callable[[str], str | None] | None = None,
    ) -> None:  # fmt: skip
        self._device, self._grips, self._clock, self._say = device, frozenset(grips), clock, say
        self._close_before, self._margin = close_before, margin
        self._grip_for = grip_for or (lambda grip: grip if grip in self._grips else None)
        self._newest: Decision | None = None
        self._used = 0  # number of the newest decision that was acted on
        self._acted_at = self._polled_at = self._kept_at = -1.0
        self._lease: tuple[str, str | None, float] | None = None
        self._phase: Phase = "reach"
        self._vetoed: tuple[str, str | None, float] | None = None
        self._veto_until = -1.0
        self._retry_at: float | None = None
        self._kept = False  # whether it holds something without a lease
        self.acting: Permit | None = None
        self.stopped = False
        self.fault: str | None = None
        self.state = DeviceState("open")
        self.events: deque[tuple[float, str]] = deque(maxlen=MAX_EVENTS)
        self.counts: Counter[str] = Counter()

    # what comes in

    def receive(self, decision: Decision) -> None:
        """Take a fresh decision, and act on it if it permits that."""
        self._newest = decision
        self._end_veto(decision)
        self.step()

    def veto(self) -> None:
        """End the action and this lease for good; the estimator is told."""
        self._vetoed = None if self._newest is None else self._newest.lease
        self._veto_until = self._clock() + VETO_HOLD
        self._say("veto")
        self._stop("veto")

    def confirm(self) -> None:
        """Tell the estimator that the user wants the present reach to be assisted."""
        self._note("confirmed")
        self._say("confirm")

    def stop(self) -> None:
        """Stop until :meth:`resume`."""
        self.stopped = True
        self.veto()

    def resume(self) -> None:
        """Allow leases to be acted on again, after a stop or a fault."""
        self.stopped, self.fault = False, None
        self._note("resumed")

    def lose(self) -> None:
        """Handle the end of the connection: nothing more will come on it."""
        self._newest = None
        self._note("the connection has ended")
        if self.acting is not None:
            self._stop("silence")

    # what happens in time

    def step(self) -> None:
        """Do what is due now."""
        now = self._clock()
        self._poll(now)
        if self._retry_at is not None and now >= self._retry_at:
            self._send_stop("fault")
        permit = self._permit(now)
        if permit is not None:
            acting = self.acting
            due = now - self._acted_at >= self._device.min_interval
            if due or acting is None or now >= acting.until:
                self._act(permit, now)
        elif self.acting is not None and now >= self.acting.until:
            self._stop("silence")
        elif self.acting is not None and not self._goes_on():
            self._stop("silence" if self._blind() else "end")
        elif self._kept and not self._blind():
            self._stop("end")
        self._keep_alive(now)

    def close(self) -> None:
        """Stop the device and let go of it."""
        self.stopped = True
        try:
            self._device.close()
        except Exception as error:  # as above
            self._note(f"closing: {_reason(error)}")
        self.acting = None

    # decisions

    def _goes_on(self) -> bool:
        """Whether the newest decision still gives the lease that is acted on."""
        newest = self._newest
        return newest is not None and newest.until > 0.0 and newest.lease == self._lease

    def _blind(self) -> bool:
        """Whether the newest decision says nothing of where the hand is going."""
        newest = self._newest
        return newest is None or newest.status in BLIND

    def _permit(self, now: float) -> Permit | None:
        """Return the permission for an action that the newest decision gives now, if any."""
        newest = self._newest
        if newest is None or newest.number <= self._used or newest.until <= 0.0:
            return None
        if newest.until - self._margin <= now:
            return None
        if self.stopped or self.fault is not None or self._retry_at is not None:
            return None
        if now < self._veto_until or newest.lease == self._vetoed:
            return None
        assert newest.target is not None
        grip = None if newest.grip is None else self._grip_for(newest.grip)
        if grip is None:
            self.counts["refused"] += 1
            return None
        phase: Phase = self._phase if newest.lease == self._lease else "reach"
        near = newest.time_to_contact is not None and newest.time_to_contact <= self._close_before
        if newest.status == "holding" or near:
            phase = "grasp"
        return Permit(
            newest.number, newest.hand, newest.target, grip, newest.model, phase,
            newest.until - self._margin,
        )  # fmt: skip

    def _end_veto(self, decision: Decision) -> None:
        if decision.until <= 0.0 and self._clock() >= self._veto_until:
            self._vetoed = None

    # actions

    def _act(self, permit: Permit, now: float) -> None:
        assert self._newest is not None
        changed = (self.acting is not None or self._kept) and self._newest.lease != self._lease
        if changed:
            self._stop("end")
            if self._retry_at is not None:
                return
        self._used, self._acted_at = permit.number, now
        try:
            self._device.allow(permit)
        except Exception as error:  # whatever a vendor's library raises, the device is stopped
            self._fail(_reason(error))
            return
        self.counts["permits"] += 1
        if self.acting is None:
            self.counts["starts"] += 1
            self._note(f"{permit.phase} {permit.target} {permit.grip}")
        elif self.acting.phase != permit.phase:
            self._note(f"{permit.phase} {permit.target} {permit.grip}")
        self.acting, self._lease, self._phase = permit, self._newest.lease, permit.phase

    def _stop(self, cause: Cause) -> None:
        if self.acting is not None or cause in ("veto", "fault"):
            self.counts[cause] += 1
            self._note(f"stop: {cause}")
        self.acting = None
        self._kept = cause == "silence" and self.state.condition == "holding"
        if cause != "silence":
            self._lease, self._phase = None, "reach"
        self._send_stop(cause)

    def _send_stop(self, cause: Cause) -> None:
        self.counts["stops"] += 1
        try:
            self._device.stop(cause)
            self._retry_at = None
        except Exception as error:  # as above; it is tried again until it succeeds
            self._retry_at = self._clock() + STOP_RETRY
            if self.fault is None:
                self.fault = _reason(error)
                self._note(f"fault: {self.fault}")

    def _fail(self, text: str) -> None:
        self.fault = text
        self._note(f"fault: {text}")
        self._stop("fault")

    # the device

    def _poll(self, now: float) -> None:
        if now - self._polled_at < POLL_INTERVAL:
            return
        self._polled_at = now
        try:
            state = self._device.state()
        except Exception as error:  # as above
            state = DeviceState("fault", _reason(error))
        before, self.state = self.state, state
        if state.condition == "fault" and self.fault is None:
            self._fail(state.detail or "the device reports a fault")
        if state.condition != before.condition:
            self._note(f"device {state.condition}")
            if before.condition == "holding" and state.condition == "open":
                self._say("opened")

    def _keep_alive(self, now: float) -> None:
        """Keep an idle connection open, but only while fresh messages come."""
        newest = self._newest
        if self.acting is not None or newest is None or self._retry_at is not None:
            return
        if newest.number > self._used and now - self._kept_at >= KEEP_ALIVE_INTERVAL:
            self._kept_at, self._used = now, newest.number
            try:
                self._device.keep_alive()
            except Exception as error:  # as above
                if self.fault is None:
                    self._fail(_reason(error))

    def _note(self, text: str) -> None:
        self.events.append((self._clock(), text))

    def status(self) -> dict[str, Any]:
        """Return what it does and why, as plain data."""
        now, newest = self._clock(), self._newest
        left = 0.0 if newest is None else max(0.0, newest.until - now)
        condition: Condition = "fault" if self.fault is not None else self.state.condition
        return {
            "device": condition, "detail": self.fault or self.state.detail,
            "acting": None if self.acting is None else self.acting.phase,
            "hand": newest and newest.hand, "status": newest and newest.status,
            "target": newest and newest.target, "grip": newest and newest.grip,
            "lease": round(left, 3), "stopped": self.stopped, "counts": dict(self.counts),
            "events": [[round(t, 3), text] for t, text in list(self.events)[-12:]],
        }  # fmt: skip


def _reason(error: Exception) -> str:
    return str(error) or type(error).__name__
