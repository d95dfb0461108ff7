"""The messages of an ``.mcap`` file, read within bounds from files that may be cut or damaged.

The package ``mcap`` parses the records and chunks. Its readers allocate whatever a damaged length
asks for and do not say where a file ends, so the records are delimited and bounded here.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from io import BytesIO
from typing import Any, BinaryIO, NamedTuple

from igrip.errors import RecordingError

MAGIC = b"\x89MCAP0\r\n"
HEAD = 9  # bytes of opcode and length before each record
MAX_BYTES = 1 << 26  # of a record, packed or not; the chunks that igrip writes have about one MB


class Record(NamedTuple):
    """One message of the file.

    Attributes
    ----------
    topic : str
        Its topic.
    number : int
        Its number within the topic, from 1.
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


class CutOffError(Exception):
    """The file ends within a record, without an end mark.

    Attributes
    ----------
    place : int
        Where that record begins [bytes].
    """

    def __init__(self, place: int) -> None:
        super().__init__(place)
        self.place = place


def read_records(file: BinaryIO) -> Iterator[Record]:
    """Yield the messages of a file in their order.

    Raises
    ------
    CutOffError
        If the file was cut off.
    RecordingError
        If it is damaged; the message names the byte.
    """
    from mcap.records import Channel, Header, Message

    channels: dict[int, Any] = {}
    counts: Counter[int] = Counter()
    numbered = False  # whether each channel counts its messages from 1, as igrip writes them
    for place, packed in _packed_records(file):
        messages = []
        try:
            for item in _unpack(packed):
                if isinstance(item, Channel):
                    channels[item.id] = item
                elif isinstance(item, Header):
                    numbered = item.library.startswith("igrip ")
                elif isinstance(item, Message):
                    channel = channels.get(item.channel_id)
                    if channel is None:
                        raise RecordingError(f"a message of an unknown channel, {item.channel_id}")
                    counts[channel.id] += 1
                    number = counts[channel.id]
                    if numbered and item.sequence != number:
                        raise RecordingError(f"damaged: of {channel.topic}, message "
                                             f"{item.sequence} follows {number - 1}")  # fmt: skip
                    t = item.log_time / 1e9
                    messages.append(Record(channel.topic, number, t, item.data, channel.metadata))
        except RecordingError as error:
            raise RecordingError(f"byte {place}: {error}") from error
        # the package mcap trusts its input: whatever it raises, the file is damaged
        except Exception as error:
            raise RecordingError(f"byte {place}: damaged: {error!r}") from error
        yield from messages


def _packed_records(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Yield place and bytes of each record that leads to messages, up to the end of the data."""
    from mcap.opcode import Opcode

    wanted = (Opcode.HEADER, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK)
    size = os.fstat(file.fileno()).st_size
    magic = file.read(len(MAGIC))
    if magic != MAGIC[: len(magic)]:
        raise RecordingError("byte 0: is no MCAP file")
    place = len(magic)
    while True:
        head = file.read(HEAD)
        length = int.from_bytes(head[1:], "little")
        # a file system may leave zeros after a crash
        if len(head) < HEAD or place + HEAD + length > size or not any(head):
            raise CutOffError(place)
        if head[0] == Opcode.DATA_END:
            return  # the index that follows is not needed
        if head[0] not in wanted:
            file.seek(length, os.SEEK_CUR)
        elif length > MAX_BYTES:
            raise RecordingError(f"byte {place}: a record of {length} bytes; at most "
                                 f"{MAX_BYTES} are read")  # fmt: skip
        else:
            yield place, head + file.read(length)
        place += HEAD + length


def _unpack(packed: bytes) -> list[Any]:
    """Return the records inside a chunk; of any other record, the record itself."""
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader, breakup_chunk

    reader = StreamReader(BytesIO(packed), skip_magic=True, emit_chunks=True)
    record = next(iter(reader.records))
    if isinstance(record, Chunk):
        return list(breakup_chunk(_bounded(record), validate_crc=True))
    return [record]


def _bounded(chunk: Any) -> Any:
    """Return a chunk, if it does not unpack to more than it may."""
    size = max(chunk.uncompressed_size, len(chunk.data))
    if chunk.compression == "zstd":
        import zstandard

        size = max(size, zstandard.frame_content_size(chunk.data))
    elif chunk.compression == "lz4":
        import lz4.frame

        # the package mcap would unpack it all, however much that is
        unpacked = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        chunk.data, chunk.compression = unpacked, ""
    if size > MAX_BYTES:
        raise RecordingError(f"a chunk of {size} bytes; at most {MAX_BYTES} are read")
    return chunk
