"""Faults of sensors, injected into any source: seeded, and on the clock of the messages."""

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
from igrip.errors import IgripError, UnknownNameError
from igrip.observation import Observation

TICK = 0.05  # s between ticks where messages fail to come, as a live source sends them
SPEC = re.compile(
    r"(?P<kind>[a-z]+)(?:@(?P<at>[\d.]+)\+(?P<lasts>[\d.]+)|:(?P<rate>[\d.]+)(?:x(?P<each>[\d.]+))?)"
)


@dataclass(frozen=True)
class Fault:
    """One kind of fault, at a time or at a rate."""

    kind: str  # of KINDS
    at: float = math.nan  # when it begins [s]; NaN: at random
    lasts: float = 0.5  # for how long [s]
    rate: float = 0.0  # how often it begins, a second, where ``at`` is NaN

    @classmethod
    def parse(cls, text: str) -> Fault:
        """Read ``freeze@3+0.5`` (at 3 s, for 0.5 s) or ``jump:0.2x0.1`` (0.2 a second, 0.1 s each).

        Raises
        ------
        IgripError
            If it is neither, or there is no such kind.
        """
        found = SPEC.fullmatch(text)
        if found is not None and found["kind"] not in KINDS:
            raise UnknownNameError("fault", found["kind"], sorted(KINDS))
        if found is None:
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
class Episode:
    """One episode of a fault, with what is drawn once for all of it."""

    random: np.random.Generator
    until: float = -math.inf
    drawn: dict[str, Any] = field(default_factory=dict)

    def once(self, key: str, draw: Callable[[], Any]) -> Any:
        """Return what was drawn for this episode, drawing it the first time."""
        if key not in self.drawn:
            self.drawn[key] = draw()
        return self.drawn[key]


def _with(message: Observation, **changes: Any) -> Observation:
    """Return a message with other hands, objects or time."""
    fields: dict[str, Any] = {"t": message.t, "hands": message.hands, "objects": message.objects}
    return Observation(**fields | changes)


def _move_hands(message: Observation, move: Callable[[str, Hand], Any]) -> Observation:
    """Return a message whose hands are elsewhere."""
    moved = {
        id: hand and msgspec.structs.replace(hand, position=move(id, hand))
        for id, hand in message.hands.items()
    }
    return _with(message, hands=moved)


def _shift_times(message: Observation, shift: float) -> Observation:
    """Return a message whose entities were measured at other times [s]."""

    def shifted(entity: Hand | ObjectPose | None) -> Any:
        if entity is None:
            return None
        t = (message.t if entity.t is None else entity.t) + shift
        return msgspec.structs.replace(entity, t=max(0.0, t))

    hands = {id: shifted(hand) for id, hand in message.hands.items()}
    objects = {id: shifted(pose) for id, pose in message.objects.items()}
    return _with(message, hands=hands, objects=objects)


def _next(ids: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield each id, sorted, with the next one; the last with the first."""
    ordered = sorted(ids)
    return zip(ordered, ordered[1:] + ordered[:1], strict=True)


def _jump(message: Observation, episode: Episode) -> Observation:
    def away(id: str, hand: Hand) -> list[float]:
        step = episode.once(id, lambda: episode.random.uniform(-1.0, 1.0, 3))
        return (np.array(hand.position) + step).tolist()  # type: ignore[no-any-return]

    return _move_hands(message, away)


def _wrong(message: Observation, episode: Episode) -> Observation:
    poses = {id: pose for id, pose in message.objects.items() if pose is not None}
    moved = {
        id: msgspec.structs.replace(
            poses[id], position=poses[other].position, orientation=poses[other].orientation
        )
        for id, other in _next(poses)
    }
    return _with(message, objects={**message.objects, **moved})


Change = Callable[[Observation, Episode], Observation | None]
KINDS: dict[str, Change] = {
    # nothing comes but ticks
    "drop": lambda message, episode: None,
    # hands stay where they were, to the last bit, at new times
    "freeze": lambda message, episode: _move_hands(
        message, lambda id, hand: episode.once(id, lambda: hand.position)
    ),
    # hands are elsewhere, by up to a metre
    "jump": _jump,
    # every hand goes by the name of the next
    "swap": lambda message, episode: _with(
        message, hands={id: message.hands[other] for id, other in _next(message.hands)}
    ),
    # hands, or objects, are looked for and not detected
    "lose": lambda message, episode: _with(message, hands=dict.fromkeys(message.hands)),
    "vanish": lambda message, episode: _with(message, objects=dict.fromkeys(message.objects)),
    # every object stands where the next one does
    "wrong": _wrong,
    # the sensors' clock is set anew, by up to two seconds
    "step": lambda message, episode: _shift_times(
        message, episode.once("step", lambda: float(episode.random.uniform(-2.0, 2.0)))
    ),
    # everything was measured long ago, or claims to come from the future
    "stale": lambda message, episode: _shift_times(message, -1.0),
    "future": lambda message, episode: _shift_times(message, 1.0),
    # every message comes twice
    "duplicate": lambda message, episode: message,
    # messages come later than they were measured: all by as much, or overtaking each other
    "delay": lambda message, episode: _shift_times(message, 0.0),
    "reorder": lambda message, episode: _shift_times(message, 0.0),
}
DELAYS: dict[str, Callable[[Episode], float]] = {  # by how much messages are held back [s]
    "delay": lambda episode: float(
        episode.once("delay", lambda: episode.random.uniform(0.05, 0.6))
    ),
    "reorder": lambda episode: float(episode.random.uniform(0.0, 0.15)),
}


def inject(
    source: Iterable[Observation],
    faults: Sequence[Fault],
    seed: int = 0,
    counts: Counter[str] | None = None,
) -> Iterator[Observation]:
    """Yield the messages of a source as they come when things go wrong, the same for the same seed.

    Times never decrease, and every message is well formed: what is wrong is their content.
    ``counts`` is increased by how many episodes of each kind began.
    """
    episodes = [Episode(np.random.default_rng([seed, k])) for k in range(len(faults))]
    held: list[tuple[float, int, Observation]] = []
    last, ticked = -math.inf, -math.inf
    for number, message in enumerate(source):
        for k, (fault, episode) in enumerate(zip(faults, episodes, strict=True)):
            if message.t > episode.until and _begins(fault, message.t, last, episode.random):
                begin = message.t if math.isnan(fault.at) else fault.at
                episodes[k] = Episode(episode.random, until=begin + fault.lasts)
                if counts is not None:
                    counts[fault.kind] += 1
        last = message.t
        while held and held[0][0] <= message.t:
            due, _, late = heapq.heappop(held)
            yield _with(late, t=due)
            ticked = due
        changed: Observation | None = message
        wait, twice = 0.0, False
        for fault, episode in zip(faults, episodes, strict=True):
            if changed is None or message.t > episode.until:
                continue
            changed = KINDS[fault.kind](changed, episode)
            wait += DELAYS[fault.kind](episode) if fault.kind in DELAYS else 0.0
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
        yield _with(late, t=max(due, last))


def _begins(fault: Fault, t: float, last: float, random: np.random.Generator) -> bool:
    if not math.isnan(fault.at):
        return last < fault.at <= t or (
            last == -math.inf and fault.at <= t <= fault.at + fault.lasts
        )
    passed = t - last if math.isfinite(last) else 0.0
    return bool(random.random() < -math.expm1(-fault.rate * passed))
