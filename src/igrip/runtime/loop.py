"""The one loop of live and service: messages from inputs, through the estimator, to outputs."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from typing import Any, NamedTuple, Protocol

from igrip.errors import IgripError, ObservationError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.observation import Observation
from igrip.runtime.bounded_queue import BoundedQueue
from igrip.runtime.clock_sync import RunClock
from igrip.runtime.envelope import Envelope, Sequencer
from igrip.runtime.latency import LatencyMeter
from igrip.runtime.protocol import Command
from igrip.runtime.sender import Sender, Senders

__all__ = ["Input", "Loop", "Output", "Sender"]

TICK = 0.05  # s of silence after which the estimator gets a tick
REPORT_INTERVAL = 1.0  # s
MAX_WARNINGS = 64  # of those that are given once each


class Input(Protocol):
    """Submits messages to the loop, from threads of its own.

    Attributes
    ----------
    single_sender : bool
        Whether all messages come from one sender and end with it: alone, such an input can run on
        the sender's clock.
    """

    single_sender: bool

    def start(self, loop: Loop) -> None:
        """Begin to submit messages."""

    def close(self) -> None:
        """Submit no more; may be called twice."""


class Output(Protocol):
    """Sends intentions to other programs."""

    def start(self, loop: Loop) -> None:
        """Open the connection."""

    def send(self, envelope: Envelope) -> None:
        """Send an intention, now or soon; blocks in piped runs only.

        Raises
        ------
        BrokenPipeError
            If nobody can receive it any more.
        """

    def close(self) -> None:
        """Send what waits, for a bounded time, and disconnect; may be called twice."""

    def counts(self) -> dict[str, int]:
        """Return how many intentions were ``sent``, how many ``lost``, and more."""


class _Item(NamedTuple):
    message: Observation | Command
    arrived: float
    sender: Sender


class Loop:
    """Runs one estimator on the messages that its inputs submit.

    Each message is dated when it is submitted, on the clock of the run, and ages count from then.
    Commands overtake observations. Where the clock runs on in silence, the estimator gets a tick
    after 50 ms without an update. As a context manager, the loop starts its inputs and outputs,
    and closes them at the end.

    Parameters
    ----------
    estimator : Estimator
        New.
    clock : RunClock
        The clock of the run.
    inputs, outputs : mapping of str to Input, to Output
        An output whose receivers have all gone is not used any more.
    piped : bool
        Whether a recording is piped through: nothing is dropped, and the run ends with its input.
    record : function, optional
        Called with every observation before the estimator is, so that it can be replayed.
    announce : function
        Called with each address at which others can connect.
    source_report : function
        Returns what is reported of the source of observations.
    warn : function
        Called with what the user should know of a sender, such as a clock that was set.

    Attributes
    ----------
    senders : Senders
        Those that have sent something.
    latency : LatencyMeter
        From the measurement of a hand to the intention that follows from it.
    """

    def __init__(
        self, estimator: Estimator, clock: RunClock, inputs: Mapping[str, Input] | None = None,
        outputs: Mapping[str, Output] | None = None, piped: bool = False,
        record: Callable[[Observation], None] | None = None,
        announce: Callable[[str], None] = lambda address: None,
        source_report: Callable[[], dict[str, Any]] = dict,
        warn: Callable[[str], None] = lambda text: None,
    ) -> None:  # fmt: skip
        self.estimator, self.piped, self.announce = estimator, piped, announce
        self._clock, self._record, self._source_report = clock, record, source_report
        self._warn, self.senders = warn, Senders()
        self._warned: set[str] = set()
        self._inputs, self._outputs = dict(inputs or {}), dict(outputs or {})
        self._broken: set[str] = set()
        self._queue: BoundedQueue[_Item] = BoundedQueue()
        self._sequencer = Sequencer(clock.now)
        self._ticker = Sender()
        self._updated = clock.now()
        self._error: Exception | None = None
        self._started = ExitStack()
        self._on_update: Callable[[list[Intention]], None] = lambda intentions: None
        self.latency = LatencyMeter()
        self._update_report()

    def __enter__(self) -> Loop:
        with ExitStack() as stack:
            parts: list[Input | Output] = [*self._outputs.values(), *self._inputs.values()]
            for part in parts:
                stack.callback(part.close)
                part.start(self)
            self._started = stack.pop_all()
        return self

    def __exit__(self, *exception: object) -> None:
        self._queue.close()
        self._started.close()
        self._update_report()

    @property
    def session(self) -> str:
        """The identifier of this run."""
        return self._sequencer.session

    @property
    def abandoned(self) -> bool:
        """Whether there are outputs and nobody receives from any of them any more."""
        return bool(self._outputs) and len(self._broken) == len(self._outputs)

    def submit(self, message: Observation | Command, sender: Sender, wait: bool = False) -> None:
        """Queue a message; ``wait`` for room rather than drop another. From any thread."""
        item = _Item(message, self._clock.now(), sender)
        self._queue.put(item, sender, wait, urgent=isinstance(message, Command))

    def now(self) -> float:
        """Return the time of the run [s]; from any thread."""
        return self._clock.now()

    def wait_for_demand(self) -> bool:
        """Block until a message could be handled at once; False: the run is over."""
        return self._queue.wait_for_reader()

    def count(self, event: str) -> None:
        """Count an event, such as a malformed message; from any thread."""
        self._queue.count(event)

    def warn(self, text: str) -> None:
        """Warn the user of something once, however often it happens; from any thread."""
        if text not in self._warned and len(self._warned) < MAX_WARNINGS:
            self._warned.add(text)
            self._warn(text)

    def finish(self, error: Exception | None = None) -> None:
        """End the run after the messages that wait; it raises ``error``, if there is one."""
        self._error = self._error or error
        self._queue.close()

    def run(self, on_update: Callable[[list[Intention]], None] = lambda intentions: None) -> None:
        """Work until :meth:`finish` is called.

        Parameters
        ----------
        on_update : function
            Called after each update with its intentions; must not block.
        """
        self._on_update = on_update
        reported = time.monotonic()
        while not self._queue.finished:
            self.step(TICK)
            if time.monotonic() - reported >= REPORT_INTERVAL:
                reported = time.monotonic()
                self._update_report()
        if self._error is not None:
            raise self._error

    def step(self, timeout: float) -> None:
        """Handle one message, if one comes within ``timeout`` [s], and a tick if one is due."""
        item = self._queue.get(timeout)
        if item is not None:
            message, arrived, sender = item
            if isinstance(message, Command):
                self._apply(message, arrived, sender)
            else:
                self._update(self._clock.stamp(message, arrived, sender.offset), sender)
            self._note(sender)
        now = self._clock.now()
        if self._clock.ticks and now - self._updated >= TICK:
            tick = self._clock.stamp(Observation(t=now), now, self._ticker.offset)
            self._update(tick, self._ticker)

    def _note(self, sender: Sender) -> None:
        """Warn of what happened to a sender; end a piped run whose numbers cannot be meant so."""
        self.senders.note(sender)
        news = sender.news(self._clock.now() if self._clock.ticks else time.monotonic())
        if news is not None:
            self._warn(news)
        if self.piped and sender.refusal is not None:
            self.finish(IgripError(f"{sender.name}: {sender.refusal}"))

    def _apply(self, command: Command, arrived: float, sender: Sender) -> None:
        self.count(command.action)
        try:
            self._send(command.apply(self.estimator), arrived)
        except IgripError as error:
            self.count("refused")
            sender.reply(ObservationError("hand", str(error)))

    def _update(self, message: Observation, sender: Sender) -> None:
        if self._record is not None:
            self._record(message)
        begin = time.perf_counter()
        intentions = self._accepted(message, sender)
        if intentions is None:
            return
        duration = time.perf_counter() - begin
        self._updated = now = self._clock.now()
        measured = [hand.t for hand in message.hands.values() if hand and hand.t is not None]
        if measured:
            self.latency.add(now, duration, now - max(measured))
        self._send(intentions, message.t)
        self._on_update(intentions)

    def _accepted(self, message: Observation, sender: Sender) -> list[Intention] | None:
        """Update the estimator, without the objects that it refuses; None: it refuses all."""
        while True:
            try:
                return self.estimator.update(message)
            except ObservationError as error:
                self.count("refused")
                sender.reply(error)
                refused = error.object_id
                objects = {id: pose for id, pose in message.objects.items() if id != refused}
                if len(objects) == len(message.objects):
                    return None
                message = Observation(t=message.t, hands=dict(message.hands), objects=objects)

    def _send(self, intentions: list[Intention], arrived: float) -> None:
        for intention in intentions:
            envelope = self._sequencer.wrap(intention, arrived)
            for name, output in self._outputs.items():
                if name in self._broken:
                    continue
                try:
                    output.send(envelope)
                except BrokenPipeError:  # its receivers have gone; the other outputs stay
                    self._broken.add(name)

    def _update_report(self) -> None:
        self._report = {
            "session": self.session, "intentions": self._sequencer.count,
            "incoming": self._queue.report(), "inputs": self.estimator.inputs(),
            "senders": self.senders.report(),
            "outputs": {name: output.counts() for name, output in self._outputs.items()},
        }  # fmt: skip

    def status(self) -> dict[str, Any]:
        """Return the counts, as of the newest report, and the latency; from any thread."""
        return self._source_report() | self._report | {"update": self.latency.summary()}
