"""Observations from the Lab Streaming Layer: motion-capture signals, or JSON as text.

Of a signal the metadata say which channel is what, as XDF's MoCap streams do. Its time stamps are
those of the sender, whose clock is followed like that of any other input.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from igrip.errors import ObservationError, requires_extra
from igrip.io.frames import METRES
from igrip.runtime.inputs import INPUTS
from igrip.runtime.inputs._named_poses import Layout, NamedPoses, channel_of
from igrip.runtime.loop import Loop, Sender
from igrip.runtime.options import Options

# pylsl raises RuntimeError where liblsl is missing
with requires_extra("pylsl", "outputs", "Lab Streaming Layer", (ImportError, RuntimeError)):
    import pylsl
    from pylsl.util import LostError
    from pylsl.util import TimeoutError as NoAnswerError

TYPES = ("mocap", "observations")  # of the streams that are read, in any case
RESOLVE_TIME = 1.0  # s of one search for streams
PATIENCE = 5.0  # s without any stream after which those that there are are named
MAX_STREAMS = 8


@INPUTS.register("lsl")
class LslInput:
    """Reads every stream of type ``MoCap`` or ``Observations``, or the one that is named.

    Streams that come later are found, those that are lost are searched for again.
    """

    single_sender = False

    def __init__(self, options: Options) -> None:
        self._name, self._frame, self._hands = options.source_name, options.frame, options.hands
        self._stop = threading.Event()
        self._open: set[str] = set()  # uids of streams that are read

    def start(self, loop: Loop) -> None:
        """Begin to search for streams, in a thread."""
        self._loop = loop
        threading.Thread(target=self._search, name="igrip-lsl", daemon=True).start()

    def close(self) -> None:
        """End all threads."""
        self._stop.set()

    def _search(self) -> None:
        begin = time.monotonic()
        while not self._stop.is_set():
            found = pylsl.resolve_streams(wait_time=RESOLVE_TIME)
            wanted = [info for info in found if self._is_wanted(info)]
            for info in wanted:
                if info.uid() not in self._open and len(self._open) < MAX_STREAMS:
                    self._open.add(info.uid())
                    threading.Thread(target=self._read, args=(info,), daemon=True).start()
            if not wanted and not self._open and time.monotonic() - begin > PATIENCE:
                self._loop.warn(self._nothing(found))

    def _is_wanted(self, info: Any) -> bool:
        if self._name is not None:
            return bool(info.name() == self._name)
        return info.type().lower() in TYPES

    def _nothing(self, found: list[Any]) -> str:
        there = ", ".join(sorted({f"{i.name()} (type {i.type()})" for i in found})) or "none at all"
        wanted = f"named {self._name!r}" if self._name else "of type MoCap"
        return (
            f"lsl: no stream {wanted} yet; streams on this network: {there}. One of another type "
            "is read with --lsl-source NAME"
        )

    def _read(self, info: Any) -> None:
        """Read one stream until it is lost."""
        try:
            inlet = pylsl.StreamInlet(info, max_buflen=10, recover=False)
            full = inlet.info(timeout=10.0)
            read = self._reader_of(full)
            if read is None:
                return  # it stays among those that are open: its metadata do not change
            while not self._stop.is_set():
                samples, stamps = inlet.pull_chunk(timeout=0.2, max_samples=64)
                for sample, stamp in zip(samples, stamps, strict=True):
                    read(sample, stamp)
        except LostError:
            self._loop.count("reconnections")
        except NoAnswerError:
            self._loop.count("unanswered")
        self._open.discard(info.uid())

    def _reader_of(self, info: Any) -> Callable[[list[Any], float], None] | None:
        """Return what handles the samples of a stream; None: they cannot be understood."""
        name = f"lsl stream {info.name()}"
        if info.channel_format() == pylsl.cf_string:
            sender = Sender(name=name, frame=self._frame)
            return lambda sample, stamp: self._submit(sender, lambda: sender.decode(sample[0]))
        metadata = list(_channels(info))
        layout = Layout(map(channel_of, metadata), self._frame.quaternions)
        if not layout.names:
            labels = ", ".join(one.get("label", "?") for one in metadata[:8]) or "no labels"
            self._loop.warn(
                f"{name}: no channels of a position. It has {info.channel_count()} channels "
                f"({labels}); label them right.x, right.y, right.z, or give object and type "
                "PositionX as XDF's MoCap streams do"
            )
            return None
        frame = self._frame
        units = {size: unit for unit, size in METRES.items()}
        if layout.metres in units and (frame.length_unit == "m" or layout.is_converted):
            frame = replace(frame, length_unit=units[layout.metres])
        # stamps are in seconds whatever the unit of times in messages
        sender = Sender(name=name, frame=replace(frame, time_unit="s"))
        poses = NamedPoses(self._hands)
        hands = sorted({id for name in layout.names if (id := poses.hand(name)) is not None})
        self._loop.announce(f"{name}: hands {', '.join(hands) or 'none'}")
        for text in poses.refused.values():
            self._loop.warn(f"{name}: {text}")

        def read(sample: list[Any], stamp: float) -> None:
            self._submit(sender, lambda: sender.read(layout.message(stamp, sample, poses)))
            for text in poses.refused.values():
                self._loop.warn(f"{name}: {text}")

        return read

    def _submit(self, sender: Sender, read: Callable[[], Any]) -> None:
        try:
            self._loop.submit(read(), sender)
        except ObservationError:
            self._loop.count("malformed")


def _channels(info: Any) -> Iterator[dict[str, str]]:
    """Yield the metadata of each channel; empty ones where there are none."""
    node = info.desc().child("channels").child("channel")
    for _ in range(info.channel_count()):
        yield (
            {key: node.child_value(key) for key in ("label", "marker", "object", "type", "unit")}
            if not node.empty()
            else {}
        )
        node = node.next_sibling("channel") if not node.empty() else node
