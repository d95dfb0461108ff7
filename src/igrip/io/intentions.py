"""Reading intentions back, and their table."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import msgspec

from igrip.errors import ObservationError, RecordingError, requires_extra
from igrip.intention import Intention
from igrip.io.intention_table import ORIGIN, Per, columns, rows_of
from igrip.io.text import read_lines

if TYPE_CHECKING:
    import pandas as pd

log = logging.getLogger(__name__)

Item = Intention | Mapping[str, Any] | bytes | str
ENDINGS = (".jsonl", ".mcap")


class Intentions(Sequence[Intention]):
    """Intentions in the order in which they were given, with where each came from.

    Parameters
    ----------
    intentions : sequence of Intention
        The messages.
    origins : sequence of mappings, optional
        ``recording`` and ``targets`` of each, as far as they are known.
    """

    def __init__(
        self, intentions: Iterable[Intention], origins: Sequence[Mapping[str, Any]] | None = None
    ) -> None:
        self._intentions = tuple(intentions)
        self.origins = [{}] * len(self._intentions) if origins is None else list(origins)

    @overload
    def __getitem__(self, index: int) -> Intention: ...
    @overload
    def __getitem__(self, index: slice) -> Intentions: ...
    def __getitem__(self, index: int | slice) -> Intention | Intentions:
        if isinstance(index, slice):
            return Intentions(self._intentions[index], self.origins[index])
        return self._intentions[index]

    def __len__(self) -> int:
        return len(self._intentions)

    def __repr__(self) -> str:
        return f"{len(self)} intentions"

    def to_frame(self, per: Per = "candidate") -> pd.DataFrame:
        """Return a tidy DataFrame.

        Parameters
        ----------
        per : str
            ``"candidate"``: a row for each intention and each object, and ``none``, that it gives
            a probability or a score to; where it gives none, one row without a candidate.
            ``"intention"``: a row for each intention, without ``candidate``, ``probability`` and
            scores.

        Returns
        -------
        pandas.DataFrame
            The columns are always the same: ``recording`` and ``targets`` (the estimator), where
            they are known; the fields of :class:`igrip.Intention`, repeated on each of its rows,
            with ``_low`` and ``_high`` for intervals and ``_x``, ``_y``, ``_z`` for points; then
            ``candidate``, ``probability``, ``score_global`` and a ``score_`` of each cue. Times in
            seconds, places in metres. ``grip_probability`` is that of ``grip``. What is unknown is
            missing (NaN or NA), never 0.

        Raises
        ------
        MissingExtraError
            If pandas is not installed.

        Examples
        --------
        >>> frame = read_intentions("intentions.jsonl").to_frame()  # doctest: +SKIP
        >>> frame.pivot_table("probability", "t", "candidate").plot()  # doctest: +SKIP
        """
        with requires_extra("pandas", "tables", "a table of intentions"):
            import pandas as pd
        rows = [
            row for intention, origin in zip(self._intentions, self.origins, strict=True)
            for row in rows_of(intention, origin, per)
        ]  # fmt: skip
        kinds = columns(per)
        frame = pd.DataFrame.from_records(rows, columns=list(kinds))
        return frame.astype({n: "float64" if k is float else "string" for n, k in kinds.items()})


def read_intentions(source: str | Path | Iterable[Item]) -> Intentions:
    """Read intentions from a file, or take them from anywhere else.

    Parameters
    ----------
    source : str, Path or iterable
        A ``.jsonl`` or ``.mcap`` that ``igrip replay --out``, ``igrip stream`` or
        :class:`igrip.Estimator` led to; or intentions, their dictionaries or their lines of JSON,
        one after another. A line that was cut off at the end of a file is left out.

    Raises
    ------
    RecordingError
        If the file cannot be read, or a line is no intention; the message names it.

    Examples
    --------
    >>> intentions = read_intentions([Intention(t=0.0, hand="right", status="idle")])
    >>> intentions[0].hand
    'right'
    """
    if isinstance(source, str | Path):
        items: Iterator[tuple[str, Item]] = _items_of(Path(source))
    else:
        items = ((f"intention {n}", item) for n, item in enumerate(source, start=1))
    intentions: list[Intention] = []
    origins: list[Mapping[str, Any]] = []
    for place, item in items:
        if isinstance(item, Intention):
            intentions.append(item)
            origins.append({})
            continue
        try:
            fields = item if isinstance(item, Mapping) else msgspec.json.decode(item)
            intentions.append(_intention_of(fields))
        except (ObservationError, msgspec.MsgspecError) as error:
            raise RecordingError(f"{place}: {_what(item)}: {error}") from None
        origins.append({name: fields[name] for name in ORIGIN if fields.get(name) is not None})
    return Intentions(intentions, origins)


def _intention_of(fields: Any) -> Intention:
    return msgspec.convert(fields, Intention)


def _what(item: object) -> str:
    text = str(item)
    if "hands" in text and "status" not in text:
        return "is an observation, no intention (igrip replay --out writes intentions)"
    return "is no intention"


def _items_of(path: Path) -> Iterator[tuple[str, Item]]:
    ending = path.suffix.lower()
    if ending in (".csv", ".parquet"):
        reader = "read_csv" if ending == ".csv" else "read_parquet"
        raise RecordingError(f"{path}: is a table already; pandas.{reader} reads it")
    if ending not in ENDINGS:
        raise RecordingError(f"{path}: intentions are read from {' or '.join(ENDINGS)}")
    return _mcap_items(path) if ending == ".mcap" else _jsonl_items(path)


def _jsonl_items(path: Path) -> Iterator[tuple[str, Item]]:
    try:
        with path.open("rb") as file:
            for line in read_lines(file):
                place = f"{path}, line {line.number}"
                if not line.ended and not _is_json(line.data):
                    log.warning("%s: cut off; it is left out", place)
                    return
                yield place, line.data
    except OSError as error:
        raise RecordingError(f"{path}: {error.strerror or error}") from error


def _is_json(data: bytes) -> bool:
    try:
        msgspec.json.decode(data)
    except msgspec.DecodeError:
        return False
    return True


def _mcap_items(path: Path) -> Iterator[tuple[str, Item]]:
    from igrip.io.mcap.messages import INTENTIONS
    from igrip.io.mcap.reader import McapReader

    for record in McapReader(path).records((INTENTIONS,)):
        yield f"{path}, message {record.number} of {record.topic}", record.data
