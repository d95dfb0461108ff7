"""Entries of the benchmark: igrip's own estimators, Python code, and programs in any language."""

from __future__ import annotations

import hashlib
import importlib
import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import msgspec

from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.targets import TARGETS

PROGRAM = "program:"
NAME = re.compile(r"[A-Za-z0-9_-]{1,40}")
START, EACH = 60.0, 0.5  # s that a program may take to begin, and for a message on average


class EntryError(IgripError, ValueError):
    """An entry of the benchmark cannot be run, or answers with something else than intentions."""


class EntryEstimator(Protocol):
    """What a Python entry returns for each recording; it begins without memory."""

    def update(self, observation: Observation) -> Iterable[Intention | Mapping[str, Any]]:
        """Return the intentions after one observation, as messages or as dictionaries."""
        ...


@dataclass(frozen=True)
class Answers:
    """What an entry answered to one recording.

    Attributes
    ----------
    intentions : list of Intention
        In order.
    seconds : float
        Time that it took [s]; of a program with its start.
    """

    intentions: list[Intention]
    seconds: float


@dataclass(frozen=True)
class Entry:
    """One entry.

    Attributes
    ----------
    name : str
        In the table.
    how : str
        ``targets``, ``python`` or ``program``.
    source : str
        Name of the targets estimator, ``module:function``, or a command.
    """

    name: str
    how: str
    source: str

    def run(self, observations: Sequence[Observation], catalog: Catalog) -> Answers:
        """Let the entry answer one recording.

        Raises
        ------
        EntryError
            If it fails, or what it returns is no intention; the message names the entry.
        """
        try:
            if self.how == "program":
                return _run_program(self.source, observations)
            return _run_python(self._estimator(catalog), observations)
        except EntryError as error:
            raise EntryError(f"{self.name}: {error}") from error
        except Exception as error:
            raise EntryError(f"{self.name}: {error!r:.300}") from error

    def digest(self) -> str:
        """Return what changes when the entry does, as far as its own files show it."""
        found = hashlib.sha256(f"{self.how} {self.source}".encode())
        for path in self._files():
            found.update(path.read_bytes())
        return found.hexdigest()[:16]

    def _files(self) -> Iterator[Path]:
        if self.how == "python":
            module = importlib.import_module(self.source.partition(":")[0])
            if module.__file__:
                yield Path(module.__file__)
        elif self.how == "program":  # the program, and the files that its command names
            program, *words = shlex.split(self.source)
            yield from (Path(w) for w in (shutil.which(program) or "", *words) if Path(w).is_file())

    def _estimator(self, catalog: Catalog) -> EntryEstimator:
        if self.how == "targets":
            return Estimator(catalog, Config(targets=self.source))
        made: EntryEstimator = _load(self.source)(catalog)
        return made


def parse_entry(text: str) -> Entry:
    """Return an entry from ``bayes``, ``NAME=module:function`` or ``NAME=program:COMMAND``.

    Raises
    ------
    EntryError
        If it has another form, or there is no such function.
    UnknownNameError
        If igrip has no such targets estimator.
    """
    name, equals, source = text.partition("=")
    if not equals:
        TARGETS.check(name)
        return Entry(name, "targets", name)
    if NAME.fullmatch(name) is None:
        raise EntryError(
            f"{text!r:.80}: give NAME=module:function or NAME={PROGRAM}COMMAND; a name has "
            "letters, digits, - and _"
        )
    if source.startswith(PROGRAM):
        if not shlex.split(source.removeprefix(PROGRAM)):
            raise EntryError(f"{name}: {PROGRAM} needs a command, such as {PROGRAM}./mine")
        return Entry(name, "program", source.removeprefix(PROGRAM))
    if source in TARGETS.names():
        return Entry(name, "targets", source)
    _load(source)
    return Entry(name, "python", source)


def _load(source: str) -> Callable[[Catalog], EntryEstimator]:
    module, colon, function = source.partition(":")
    if not colon:
        raise EntryError(f"{source!r:.80}: give module:function")
    if "" not in sys.path:
        sys.path.insert(0, "")  # a module beside where the command runs
    try:
        found = getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError) as error:
        raise EntryError(f"{source!r:.80}: {error}") from error
    made: Callable[[Catalog], EntryEstimator] = found
    return made


def _run_python(estimator: EntryEstimator, observations: Sequence[Observation]) -> Answers:
    found: list[Intention | Mapping[str, Any]] = []
    begin = time.perf_counter()
    for observation in observations:
        found += estimator.update(observation)
    seconds = time.perf_counter() - begin
    return Answers([_intention(one) for one in found], seconds)


def _run_program(command: str, observations: Sequence[Observation]) -> Answers:
    """Give a program the observations as lines of JSON, and read its intentions."""
    limit = START + EACH * len(observations)
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder) / "observations.jsonl"
        with given.open("w", encoding="utf-8") as file:
            file.writelines(json.dumps(o.to_dict()) + "\n" for o in observations)
        begin = time.perf_counter()
        try:
            with given.open("rb") as lines:
                done = subprocess.run(
                    shlex.split(command), stdin=lines, capture_output=True, timeout=limit,
                    check=False,
                )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise EntryError(f"took more than {limit:.0f} s for one recording") from None
        except OSError as error:
            raise EntryError(f"{command!r:.80}: {error.strerror or error}") from error
        seconds = time.perf_counter() - begin
    if done.returncode:
        last = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
        raise EntryError(f"ended with exit code {done.returncode}: {' '.join(last):.200}")
    return Answers([_intention(line) for line in done.stdout.splitlines() if line], seconds)


def _intention(found: Intention | Mapping[str, Any] | bytes) -> Intention:
    if isinstance(found, Intention):
        return found
    try:
        fields = msgspec.json.decode(found) if isinstance(found, bytes) else found
        return msgspec.convert(fields, Intention)
    except msgspec.MsgspecError as error:
        raise EntryError(f"answered what is no intention: {found!r:.100}: {error}") from None
