"""Reading MCAP recordings, cut off or not, record by record and within bounds."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from igrip.errors import MissingExtraError, ObservationError, RecordingError
from igrip.io.recordings import foxglove
from igrip.io.recordings.messages import OBSERVATIONS
from igrip.observation import Observation
from igrip.rgbd import Array, Intrinsics, RgbdFrame

log = logging.getLogger(__name__)

MAGIC = b"\x89MCAP0\r\n"
LARGEST = 1 << 26  # bytes of a chunk when unpacked; those igrip writes have about one MB


class Record(NamedTuple):
    """One message of the file.

    Attributes
    ----------
    topic : str
        Its topic.
    number : int
        Which of its topic it is, from 1 on.
    t : float
        Its time [s].
    data : bytes
        Its payload.
    metadata : dict
        Of its channel.
    """

    topic: str
    number: int
    t: float
    data: bytes
    metadata: dict[str, str]


@dataclass
class _Tables:
    """What a reader has learned so far."""

    channels: dict[int, Any] = field(default_factory=dict)
    counts: dict[int, int] = field(default_factory=dict)
    sequences: dict[int, int] = field(default_factory=dict)
    igrip: bool = False


class McapReader:
    """The observations of an ``.mcap`` file, in order; may be iterated again.

    A file that was cut off (a full disk, a killed recorder) yields everything before the cut;
    :attr:`cut` then says where it was, and a warning is logged.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    RecordingError
        If the file cannot be opened; while iterating, if it is damaged, or a message is malformed
        (file, message and field are named).
    MissingExtraError
        If the package ``mcap`` is not installed.
    """

    def __init__(self, path: str | Path) -> None:
        try:
            import mcap.records  # noqa: F401
        except ImportError:
            raise MissingExtraError("mcap", "mcap", "MCAP recordings") from None
        self.path = Path(path)
        self.cut: str | None = None
        if not self.path.exists() or self.path.is_dir():
            what = "is a folder" if self.path.is_dir() else "no such file"
            raise RecordingError(f"{self.path}: {what}")

    def __iter__(self) -> Iterator[Observation]:
        last = -1.0
        for record in self.records((OBSERVATIONS,)):
            try:
                observation = Observation.from_json(record.data)
                if observation.t < last:
                    raise ObservationError("t", f"decreased from {last!r} to {observation.t!r}")
            except ObservationError as error:
                raise self._malformed(record, error) from error
            last = observation.t
            yield observation

    def frames(self) -> Iterator[RgbdFrame]:
        """Yield the frames of all cameras as they were recorded, each camera's in order of time.

        Raises
        ------
        RecordingError
            If the file is damaged or a frame malformed.
        """
        calibrations: dict[str, Intrinsics] = {}
        places: dict[str, Array] = {}
        depths: dict[str, tuple[float, Any]] = {}
        last: dict[str, float] = {}
        for record in self.records():
            camera, _, kind = record.topic[1:].rpartition("/")
            try:
                if record.topic == "/tf":
                    name, place = foxglove.decode_place(record.data)
                    places[name] = place
                elif kind == "calibration":
                    calibrations[camera] = foxglove.decode_calibration(record.data)
                elif kind == "depth":
                    depths[camera] = record.t, _depth(record)
                elif kind == "colour":
                    if record.t < last.get(camera, 0.0):
                        raise RecordingError("timestamp: decreased")
                    last[camera] = record.t
                    yield _frame(
                        camera, record, calibrations.get(camera), depths.pop(camera, None),
                        places.get(camera),
                    )  # fmt: skip
            except RecordingError as error:
                raise self._malformed(record, error) from error

    def records(self, topics: tuple[str, ...] = ()) -> Iterator[Record]:
        """Yield the messages of some topics, or of all, in the order of the file.

        Raises
        ------
        RecordingError
            If the file is damaged.
        """
        self.cut = None
        known, read = _Tables(), 0
        try:
            file = self.path.open("rb")
        except OSError as error:
            raise RecordingError(f"{self.path}: {error.strerror or error}") from error
        with file:
            for at, opcode, body in self._outer(file):
                if body is None:
                    self.cut = f"{self.path}: cut off at byte {at}; {read} messages read"
                    log.warning(self.cut)
                    return
                try:
                    found = list(_unpack(opcode, body, known))
                except RecordingError as error:
                    raise RecordingError(f"{self.path}, byte {at}: {error}") from error
                # the library's reader trusts its input: whatever it raises, the file is damaged
                except Exception as error:
                    raise RecordingError(f"{self.path}, byte {at}: damaged: {error!r}") from error
                for record in found:
                    read += 1
                    if not topics or record.topic in topics:
                        yield record

    def _outer(self, file: BinaryIO) -> Iterator[tuple[int, int, bytes | None]]:
        """Yield place, opcode and content of each record; no content: cut off there."""
        from mcap.opcode import Opcode

        size = os.fstat(file.fileno()).st_size
        magic = file.read(len(MAGIC))
        if magic != MAGIC[: len(magic)]:
            raise RecordingError(f"{self.path}: is no MCAP file")
        at = len(magic)
        while True:
            head = file.read(9)
            length = int.from_bytes(head[1:], "little")
            if len(head) < 9 or at + 9 + length > size:
                yield at, 0, None
                return
            if head[0] == Opcode.DATA_END:
                return  # an index follows, which is not needed to read on
            if head[0] == 0 and length == 0:  # zeros, left by a file system after a crash
                yield at, 0, None
                return
            wanted = head[0] in (Opcode.HEADER, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE,
                                 Opcode.CHUNK)  # fmt: skip
            if wanted and length > LARGEST:
                raise RecordingError(f"{self.path}, byte {at}: a record of {length} bytes; at most "
                                     f"{LARGEST} are read")  # fmt: skip
            if wanted:
                yield at, head[0], file.read(length)
            else:
                file.seek(length, os.SEEK_CUR)
            at += 9 + length

    def _malformed(self, record: Record, error: Exception) -> RecordingError:
        return RecordingError(f"{self.path}, message {record.number} of {record.topic}: {error}")


def _unpack(opcode: int, body: bytes, known: _Tables) -> Iterator[Record]:
    """Yield the messages of one outer record, and remember its channels."""
    from mcap.data_stream import ReadDataStream
    from mcap.opcode import Opcode
    from mcap.records import Channel, Header, Message
    from mcap.stream_reader import breakup_chunk

    stream = ReadDataStream(BytesIO(body))
    if opcode == Opcode.CHUNK:
        inner = breakup_chunk(_bounded(stream), validate_crc=True)
    elif opcode == Opcode.HEADER:
        known.igrip = Header.read(stream).library.startswith("igrip ")
        return
    elif opcode == Opcode.CHANNEL:
        inner = [Channel.read(stream)]
    elif opcode == Opcode.MESSAGE:
        inner = [Message.read(stream, len(body))]
    else:
        return
    for item in inner:
        if isinstance(item, Channel):
            known.channels[item.id] = item
        elif isinstance(item, Message):
            channel = known.channels.get(item.channel_id)
            if channel is None:
                raise RecordingError(f"a message of an unknown channel, {item.channel_id}")
            before = known.sequences.get(channel.id, 0)
            if known.igrip and item.sequence != before + 1:
                raise RecordingError(
                    f"damaged: of {channel.topic}, message {item.sequence} follows {before}"
                )
            known.sequences[channel.id] = item.sequence
            number = known.counts[channel.id] = known.counts.get(channel.id, 0) + 1
            yield Record(channel.topic, number, item.log_time / 1e9, item.data, channel.metadata)


def _bounded(stream: Any) -> Any:
    """Return a chunk, if it does not unpack to more than it may."""
    from mcap.records import Chunk

    chunk = Chunk.read(stream)
    size = max(chunk.uncompressed_size, len(chunk.data))
    if chunk.compression == "zstd":
        import zstandard

        size = max(size, zstandard.frame_content_size(chunk.data))
    elif chunk.compression == "lz4":
        import lz4.frame

        # the library would unpack it all, however much that is
        unpacked = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        chunk.data, chunk.compression = unpacked, ""
    if size > LARGEST:
        raise RecordingError(f"a chunk of {size} bytes; at most {LARGEST} are read")
    return chunk


def _depth(record: Record) -> Any:
    """Return the depth of a record, shape (h, w) float32 [m]."""
    counts = foxglove.decode_picture(record.data)
    if counts.dtype != np.uint16:
        raise RecordingError("data: depth must have 16 bits")
    try:
        unit = float(record.metadata.get("depth_unit_m", "0.001"))
    except ValueError:
        unit = 0.0
    if not 0.0 < unit < 1.0:
        raise RecordingError("depth_unit_m: must be a length in metres")
    metres = (np.arange(65536) * unit).astype(np.float32)
    return metres[counts]


def _frame(
    camera: str,
    record: Record,
    intrinsics: Intrinsics | None,
    depth: tuple[float, Any] | None,
    place: Array | None,
) -> RgbdFrame:
    colour = foxglove.decode_picture(record.data)
    if intrinsics is None:
        raise RecordingError("no calibration comes before this picture")
    shape = (intrinsics.height, intrinsics.width)
    own = depth[1] if depth is not None and depth[0] == record.t else None
    if colour.shape != (*shape, 3) or (own is not None and own.shape != shape):
        raise RecordingError(f"data: {colour.shape[1]} × {colour.shape[0]}, but the calibration "
                             f"says {shape[1]} × {shape[0]}")  # fmt: skip
    frame = RgbdFrame(record.t, colour, own, intrinsics, camera)
    if place is None:
        return frame
    return RgbdFrame(record.t, colour, own, intrinsics, camera, place)
