"""What goes wrong with sensors, on purpose: seeded, on the clock of the messages, on any source."""

from __future__ import annotations

import heapq
import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np

from igrip.entities import Hand, ObjectPose
from igrip.errors import IgripError
from igrip.observation import Observation

TICK = 0.05  # s between ticks where messages fail to come, as a live source sends them
SPEC = re.compile(
    r"(?P<kind>[a-z]+)(?:@(?P<at>[\d.]+)\+(?P<lasts>[\d.]+)|:(?P<rate>[\d.]+)(?:x(?P<each>[\d.]+))?)"
)


@dataclass(frozen=True)
class Fault:
    """One kind of fault, at a time or at a rate.

    Attributes
    ----------
    kind : str
        One of :data:`KINDS`.
    at : float
        When it begins [s]; NaN: at random.
    lasts : float
        For how long [s].
    rate : float
        How often it begins, a second, where ``at`` is NaN.
    """

    kind: str
    at: float = math.nan
    lasts: float = 0.5
    rate: float = 0.0

    @classmethod
    def parse(cls, text: str) -> Fault:
        """Read ``freeze@3+0.5`` (at 3 s, for 0.5 s) or ``jump:0.2x0.1`` (0.2 a second, 0.1 s each).

        Raises
        ------
        IgripError
            If it is neither, or there is no such kind.
        """
        found = SPEC.fullmatch(text)
        if found is None or found["kind"] not in KINDS:
            raise IgripError(
                f"fault {text!r:.80}: expected KIND@BEGIN+SECONDS or KIND:RATE[xSECONDS], such as "
                f"freeze@3+0.5 or jump:0.2x0.1; kinds: {', '.join(sorted(KINDS))}"
            )
        try:
            if found["at"] is not None:
                return cls(found["kind"], float(found["at"]), float(found["lasts"]))
            lasts = float(found["each"] or 0.3)
            return cls(found["kind"], lasts=lasts, rate=float(found["rate"]))
        except ValueError as error:
            raise IgripError(f"fault {text!r:.80}: {error}") from None


@dataclass
class Memory:
    """What a fault of one kind keeps while it lasts."""

    random: np.random.Generator
    until: float = -math.inf
    kept: dict[str, Any] = field(default_factory=dict)

    def once(self, key: str, draw: Callable[[], Any]) -> Any:
        """Return what was drawn for this spell, drawing it the first time."""
        if key not in self.kept:
            self.kept[key] = draw()
        return self.kept[key]


Change = Callable[[Observation, Memory], Observation | None]
KINDS: dict[str, Change] = {}
LATE: dict[str, Callable[[Memory], float]] = {}  # kinds that only hold messages back, by how much


def _kind(name: str) -> Callable[[Change], Change]:
    def keep(change: Change) -> Change:
        KINDS[name] = change
        return change

    return keep


def _hands(message: Observation, change: Callable[[str, Hand], Hand | None]) -> Observation:
    hands = {id: h if h is None else change(id, h) for id, h in message.hands.items()}
    return Observation(t=message.t, hands=hands, objects=dict(message.objects))


def _all(message: Observation, shift: float) -> Observation:
    """Return a message whose entities were measured at other times."""

    def moved(entity: Hand | ObjectPose) -> Any:
        t = (message.t if entity.t is None else entity.t) + shift
        return msgspec.structs.replace(entity, t=max(0.0, t))

    return Observation(
        t=message.t,
        hands={id: h and moved(h) for id, h in message.hands.items()},
        objects={id: o and moved(o) for id, o in message.objects.items()},
    )


@_kind("drop")
def _drop(message: Observation, memory: Memory) -> Observation | None:
    """Nothing comes but ticks."""
    return None


@_kind("freeze")
def _freeze(message: Observation, memory: Memory) -> Observation:
    """Hands stay where they were, to the last bit, at new times."""
    return _hands(
        message,
        lambda id, h: msgspec.structs.replace(h, position=memory.once(id, lambda: h.position)),
    )


@_kind("jump")
def _jump(message: Observation, memory: Memory) -> Observation:
    """Hands are elsewhere, by up to a metre."""

    def away(id: str, h: Hand) -> Hand:
        step = memory.once(id, lambda: memory.random.uniform(-1.0, 1.0, 3))
        return msgspec.structs.replace(h, position=tuple((np.array(h.position) + step).tolist()))

    return _hands(message, away)


@_kind("swap")
def _swap(message: Observation, memory: Memory) -> Observation:
    """Every hand goes by the name of the next."""
    ids = sorted(message.hands)
    hands = {id: message.hands[other] for id, other in zip(ids, ids[1:] + ids[:1], strict=True)}
    return Observation(t=message.t, hands=hands, objects=dict(message.objects))


@_kind("lose")
def _lose(message: Observation, memory: Memory) -> Observation:
    """Hands are looked for and not seen."""
    return _hands(message, lambda id, h: None)


@_kind("vanish")
def _vanish(message: Observation, memory: Memory) -> Observation:
    """Objects are looked for and not seen."""
    return Observation(
        t=message.t, hands=dict(message.hands), objects=dict.fromkeys(message.objects)
    )


@_kind("wrong")
def _wrong(message: Observation, memory: Memory) -> Observation:
    """Every object stands where the next one does."""
    ids = sorted(id for id, pose in message.objects.items() if pose is not None)
    objects = dict(message.objects)
    for id, other in zip(ids, ids[1:] + ids[:1], strict=True):
        there, own = message.objects[other], message.objects[id]
        assert there is not None
        assert own is not None
        objects[id] = msgspec.structs.replace(
            own, position=there.position, orientation=there.orientation
        )
    return Observation(t=message.t, hands=dict(message.hands), objects=objects)


@_kind("step")
def _step(message: Observation, memory: Memory) -> Observation:
    """Set the sensors' clock anew, by up to two seconds."""
    return _all(message, memory.once("step", lambda: float(memory.random.uniform(-2.0, 2.0))))


@_kind("stale")
def _stale(message: Observation, memory: Memory) -> Observation:
    """Everything was measured long ago."""
    return _all(message, -1.0)


@_kind("future")
def _future(message: Observation, memory: Memory) -> Observation:
    """Everything claims to come from the future."""
    return _all(message, 1.0)


@_kind("duplicate")
def _duplicate(message: Observation, memory: Memory) -> Observation:
    """Every message comes twice; see :func:`inject`."""
    return message


@_kind("delay")
def _delay(message: Observation, memory: Memory) -> Observation:
    """Messages come later than they were measured, all by as much; see :func:`inject`."""
    return _all(message, 0.0)


@_kind("reorder")
def _reorder(message: Observation, memory: Memory) -> Observation:
    """Messages overtake each other; see :func:`inject`."""
    return _all(message, 0.0)


LATE["delay"] = lambda memory: float(memory.once("delay", lambda: memory.random.uniform(0.05, 0.6)))
LATE["reorder"] = lambda memory: float(memory.random.uniform(0.0, 0.15))


def inject(
    source: Iterable[Observation],
    faults: Sequence[Fault],
    seed: int = 0,
    counts: Counter[str] | None = None,
) -> Iterator[Observation]:
    """Yield the messages of a source as they come when things go wrong.

    Times never decrease, and every message is well formed: what is wrong is what they say.

    Parameters
    ----------
    source : iterable of Observation
        In order of time.
    faults : sequence of Fault
        What goes wrong, and when.
    seed : int
        Of what is drawn.
    counts : Counter, optional
        How many spells of each kind began is counted here.
    """
    memories = [Memory(np.random.default_rng([seed, k])) for k in range(len(faults))]
    held: list[tuple[float, int, Observation]] = []
    last, ticked = -math.inf, -math.inf
    for number, message in enumerate(source):
        for k, (fault, memory) in enumerate(zip(faults, memories, strict=True)):
            if message.t > memory.until and _begins(fault, message.t, last, memory.random):
                end = message.t + fault.lasts if math.isnan(fault.at) else fault.at + fault.lasts
                memories[k] = Memory(memory.random, until=end)
                if counts is not None:
                    counts[fault.kind] += 1
        last = message.t
        while held and held[0][0] <= message.t:
            due, _, late = heapq.heappop(held)
            yield _arriving(late, due)
            ticked = due
        changed: Observation | None = message
        wait, twice = 0.0, False
        for fault, memory in zip(faults, memories, strict=True):
            if changed is None or message.t > memory.until:
                continue
            changed = KINDS[fault.kind](changed, memory)
            wait += LATE[fault.kind](memory) if fault.kind in LATE else 0.0
            twice |= fault.kind == "duplicate"
        if changed is None or wait:
            if changed is not None:
                heapq.heappush(held, (message.t + wait, number, changed))
            if message.t - ticked < TICK:
                continue
            changed, twice = Observation(t=message.t), False
        ticked = message.t
        yield changed
        if twice:
            yield changed
    for due, _, late in sorted(held, key=lambda one: one[:2]):
        yield _arriving(late, max(due, last))


def _begins(fault: Fault, t: float, last: float, random: np.random.Generator) -> bool:
    if not math.isnan(fault.at):
        return last < fault.at <= t or (
            last == -math.inf and fault.at <= t <= fault.at + fault.lasts
        )
    passed = t - last if math.isfinite(last) else 0.0
    return bool(random.random() < -math.expm1(-fault.rate * passed))


def _arriving(message: Observation, t: float) -> Observation:
    """Return a message that arrives at another time."""
    return Observation(t=t, hands=dict(message.hands), objects=dict(message.objects))


def every_kind(rate: float, lasts: float = 0.3) -> list[Fault]:
    """Return faults of every kind at random, ``rate`` a second in all."""
    return [Fault(kind, lasts=lasts, rate=rate / len(KINDS)) for kind in KINDS]
