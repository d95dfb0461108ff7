"""Writing ``.mcap`` recordings: camera frames and messages in one file.

Topics: ``/CAMERA/colour``, ``/CAMERA/depth``, ``/CAMERA/calibration``, ``/CAMERA/annotations``,
``/tf`` (protobuf, as Foxglove draws them), ``/observations``, ``/intentions``, ``/events``,
``/detections`` (JSON, each message the same line as in a ``.jsonl``). Times are those of the
data, on one monotonic clock.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import msgspec

from igrip.errors import RecordingError, requires_extra
from igrip.io.files import CrashSafeFile, RecordingWriter
from igrip.io.mcap import foxglove
from igrip.io.mcap.messages import Detections, Event, Message, schema_of, topic_of
from igrip.rgbd import RgbdFrame
from igrip.version import __version__

log = logging.getLogger(__name__)

FLUSH_EVERY = 0.4  # s; with the flush itself, at most half a second is lost
CHUNK = 8 << 20  # bytes; large, so that a flush ends a chunk and few chunks are indexed in memory
REPEAT_EVERY = 1.0  # s; calibration and place are repeated, for readers that seek


class McapWriter(RecordingWriter):
    """Write frames and messages to an ``.mcap`` file, from one or several threads.

    Twice a second the writer flushes its data, and a background thread syncs them to the disk, so a
    crash or a kill costs at most half a second. After a disk error the file is cut back to its last
    whole record and stays readable.

    Parameters
    ----------
    path : str or Path
        The file; an existing one is replaced.
    depth_unit : float
        Length of one count of a depth picture [m]; depths beyond 65535 counts become 0.
    lossless : bool
        Whether to write colour as PNG (slower, and several times larger) instead of JPEG.

    Raises
    ------
    RecordingError
        If the file cannot be opened; while writing, if the disk is full or fails, now or since the
        last call.
    MissingExtraError
        If the package ``mcap`` is not installed.

    Examples
    --------
    >>> with McapWriter("reach.mcap") as file:  # doctest: +SKIP
    ...     file.write_frame(frame)
    ...     file.write(observation)
    """

    def __init__(
        self,
        path: str | Path,
        depth_unit: float = foxglove.DEPTH_UNIT,
        lossless: bool = False,
    ) -> None:
        with requires_extra("mcap", "mcap", "MCAP recordings"):
            from mcap.writer import Writer
        self.path = Path(path)
        self._unit, self._lossless = depth_unit, lossless
        self._sink = CrashSafeFile(path)
        self._lock = threading.Lock()  # of the writer, the sink and all below
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._counts: Counter[str] = Counter()
        self._settled: dict[str, tuple[float, Any]] = {}
        self._failure: RecordingError | None = None
        self._raised = self._unflushed = False
        self._flushed = time.monotonic()
        self._writer = Writer(self._sink, chunk_size=CHUNK)
        self._do(partial(self._writer.start, "", f"igrip {__version__}"))
        self._do(partial(self._writer.add_metadata, "igrip", {"version": __version__,
                 "clock": "monotonic", "depth_unit_m": repr(depth_unit)}))  # fmt: skip
        self._closed = threading.Event()
        self._flusher = threading.Thread(target=self._keep_flushing, daemon=True)
        self._flusher.start()

    @property
    def counts(self) -> dict[str, int]:
        """How many messages were written, by topic."""
        with self._lock:
            return dict(self._counts)

    @property
    def size(self) -> int:
        """How much of the file has left the process [bytes]."""
        return self._sink.tell()

    def write(self, message: Message, **more: Any) -> None:
        """Append one message, with further fields in its JSON."""
        data = message.to_json()
        if more:
            data = msgspec.json.encode(msgspec.json.decode(data) | more)
        self._put(topic_of(message), message.t, data)
        if isinstance(message, Detections):
            annotations = foxglove.encode_annotations(message)
            self._put(f"/{message.camera}/annotations", message.t, annotations)

    def write_frame(self, frame: RgbdFrame) -> None:
        """Append one frame, encoded in the calling thread."""
        if frame.camera.strip("/") != frame.camera or not frame.camera:
            raise RecordingError(f"{self.path}: a camera cannot be named {frame.camera!r}")
        colour = foxglove.encode_colour(frame, self._lossless)
        depth = None if frame.depth is None else foxglove.encode_depth(frame, self._unit)
        place = (frame.intrinsics, frame.world_from_camera.tobytes())
        since, settled = self._settled.get(frame.camera, (0.0, None))
        if settled != place or not 0.0 <= frame.t - since < REPEAT_EVERY:
            self._settled[frame.camera] = frame.t, place
            self._put("/tf", frame.t, foxglove.encode_transform(frame))
            topic = f"/{frame.camera}/calibration"
            self._put(topic, frame.t, foxglove.encode_calibration(frame))
        if depth is not None:  # before colour, which completes a frame
            self._put(f"/{frame.camera}/depth", frame.t, depth)
        self._put(f"/{frame.camera}/colour", frame.t, colour)

    def write_event(self, t: float, name: str, **data: Any) -> None:
        """Append an event."""
        self.write(Event(t=t, name=name, data=data))

    def close(self) -> None:
        """Finish and close the file.

        Raises
        ------
        RecordingError
            If the disk failed and no call has raised it yet.
        """
        if self._closed.is_set():
            return
        self._closed.set()
        self._flusher.join()
        with self._lock:
            for step in (self._writer.flush, self._writer.finish, self._sink.sync):
                if self._failure is None:
                    self._do(step)
            self._sink.close()
            if self._failure is not None and not self._raised:
                self._raised = True
                raise self._failure

    def __exit__(self, *exception: object) -> None:
        try:
            self.close()
        except RecordingError:
            if exception[0] is None:  # else that error is raised, which may be this one
                raise

    def _put(self, topic: str, t: float, data: bytes) -> None:
        with self._lock:
            if self._closed.is_set():
                raise RecordingError(f"{self.path}: is closed")
            if self._failure is None:
                self._do(partial(self._add, topic, foxglove.nanoseconds(t), data))
            if self._failure is not None:
                self._raised = True
                raise self._failure

    def _add(self, topic: str, ns: int, data: bytes) -> None:
        channel = self._channels.get(topic) or self._register(topic)
        self._counts[topic] += 1  # a gap shows a reader what was lost
        self._writer.add_message(channel, ns, data, ns, self._counts[topic])
        self._unflushed = True
        # here too, since the thread may be waiting for the disk
        if time.monotonic() - self._flushed >= FLUSH_EVERY:
            self._flush()

    def _flush(self) -> None:
        self._writer.flush()
        self._unflushed, self._flushed = False, time.monotonic()

    def _register(self, topic: str) -> int:
        kind = topic.rpartition("/")[2]
        if kind in foxglove.TYPES:
            name, description, _ = foxglove.schema(foxglove.TYPES[kind])
            encoding = form = "protobuf"
        else:
            (name, description), encoding, form = schema_of(topic), "jsonschema", "json"
        if name not in self._schemas:
            self._schemas[name] = self._writer.register_schema(name, encoding, description)
        metadata = {"depth_unit_m": repr(self._unit)} if kind == "depth" else {}
        channel: int = self._writer.register_channel(topic, form, self._schemas[name], metadata)
        self._channels[topic] = channel
        return channel

    def _do(self, step: Callable[[], Any]) -> None:
        """Run one step of the writer; after an error the file is as it was before the step."""
        try:
            step()
            self._sink.mark()
        except OSError as error:
            self._failure = self._sink.failure(error)
            log.error(str(self._failure))
            self._cut_back()
        except BaseException:  # Ctrl-C in the middle of a record
            self._failure = RecordingError(f"{self.path}: interrupted")
            self._cut_back()
            raise

    def _cut_back(self) -> None:
        try:
            self._sink.cut_back()
        except OSError as error:  # a reader stops before the broken record
            log.error(f"{self.path}: cannot be cut back: {error}")

    def _keep_flushing(self) -> None:
        synced = 0
        while not self._closed.wait(FLUSH_EVERY):
            with self._lock:
                if self._failure is not None:
                    return
                if self._unflushed:
                    self._do(self._flush)
            if self._sink.tell() == synced:
                continue
            synced = self._sink.tell()
            try:
                self._sink.sync()  # without the lock, since it may take long
            except OSError as error:
                with self._lock:
                    self._failure = RecordingError(f"{self.path}: {error.strerror or error}")
