"""Entries of the benchmark: igrip's own estimators, Python code, and programs in any language."""

from __future__ import annotations

import hashlib
import importlib
import json
import math
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

from igrip.config import Config
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.lab.benchmark.answers import Answers, EntryError, checked, intention_of
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.targets import TARGETS

PROGRAM = "program:"
NAME = re.compile(r"[A-Za-z0-9_-]{1,40}")
SHOWN = 5  # lines of what a program that fails has printed
START, EACH = 60.0, 0.5  # s that a program may take to begin, and for a message on average


class EntryEstimator(Protocol):
    """What a Python entry returns for each recording; it begins without memory."""

    def update(self, observation: Observation) -> Iterable[Intention | Mapping[str, Any]]:
        """Return the intentions after one observation, as messages or as dictionaries."""
        ...


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
            place = traceback.extract_tb(error.__traceback__)[-1]
            raise EntryError(
                f"{self.name}: {error!r:.300} ({Path(place.filename).name}, line {place.lineno})"
            ) from error

    def digest(self) -> str:
        """Return what changes when the entry does, as far as its own files show it."""
        words = hashlib.sha256(f"{self.how} {self.source}".encode()).hexdigest()[:8]
        return f"{words}-{_digest_of(self._files())}"

    def _files(self) -> Iterator[Path]:
        if self.how == "python":
            module = _module(self.source.partition(":")[0])
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
        try:
            words = shlex.split(source.removeprefix(PROGRAM))
        except ValueError as error:
            raise EntryError(f"{name}: {error}") from error
        if not words:
            raise EntryError(f"{name}: {PROGRAM} needs a command, such as {PROGRAM}./mine")
        return Entry(name, "program", source.removeprefix(PROGRAM))
    if source in TARGETS.names():
        return Entry(name, "targets", source)
    _load(source)
    return Entry(name, "python", source)


_modules: dict[str, str] = {}  # what their files were when they were loaded


def _module(name: str) -> ModuleType:
    """Return a module as its file is now: a worker of a cluster outlives many versions."""
    importlib.invalidate_caches()
    module = importlib.import_module(name)
    now = "" if not module.__file__ else _digest_of([Path(module.__file__)])
    if _modules.setdefault(name, now) != now:
        module = importlib.reload(module)
        _modules[name] = now
    return module


def _digest_of(files: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _load(source: str) -> Callable[[Catalog], EntryEstimator]:
    module, colon, function = source.partition(":")
    if not colon:
        raise EntryError(f"{source!r:.80}: give module:function")
    if "" not in sys.path:
        sys.path.insert(0, "")  # a module beside where the command runs
    try:
        found = getattr(_module(module), function)
    except Exception as error:  # whatever a module does when it is imported
        raise EntryError(f"{source!r:.80}: {error}") from error
    made: Callable[[Catalog], EntryEstimator] = found
    return made


def _run_python(estimator: EntryEstimator, observations: Sequence[Observation]) -> Answers:
    found: list[Intention] = []
    seconds = 0.0
    for observation in observations:
        begin = time.perf_counter()
        answers = list(estimator.update(observation))
        seconds += time.perf_counter() - begin
        for one in map(intention_of, answers):
            if one.t != observation.t:
                raise EntryError(
                    f"answered with t = {one.t:g} to an observation at t = {observation.t:g}: an "
                    "intention has the time of the observation that it follows"
                )
            found.append(one)
    return Answers(checked(found, observations), seconds)


def _run_program(command: str, observations: Sequence[Observation]) -> Answers:
    """Give a program the observations as lines of JSON, and read its intentions."""
    limit = START + EACH * len(observations)
    with tempfile.TemporaryDirectory() as folder:
        given = Path(folder) / "observations.jsonl"
        with given.open("w", encoding="utf-8") as file:
            file.writelines(json.dumps(o.to_dict()) + "\n" for o in observations)
        begin = time.perf_counter()
        with given.open("rb") as lines:
            try:
                program = subprocess.Popen(
                    shlex.split(command), stdin=lines, stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE, start_new_session=True,
                )  # fmt: skip
            except OSError as error:
                raise EntryError(f"{command!r:.80}: {error.strerror or error}") from error
            try:
                output, errors = program.communicate(timeout=limit)
            except subprocess.TimeoutExpired:
                raise EntryError(f"took more than {limit:.0f} s for one recording") from None
            finally:
                _end(program)
        seconds = time.perf_counter() - begin
    if program.returncode:
        last = errors.decode(errors="replace").strip().splitlines()[-SHOWN:]
        raise EntryError(f"ended with exit code {program.returncode}: {' | '.join(last):.400}")
    found = [intention_of(line) for line in output.splitlines() if line]
    times = {observation.t for observation in observations}
    newest = -math.inf
    for one in found:
        if one.t not in times or one.t < newest:
            raise EntryError(
                f"answered with t = {one.t:g}: an intention has the time of the observation that "
                "it follows, and they are in order"
            )
        newest = one.t
    return Answers(checked(found, observations), seconds)


def _end(program: subprocess.Popen[bytes]) -> None:
    """End a program that still runs, with what it has started."""
    if program.poll() is None:
        try:
            os.killpg(program.pid, signal.SIGKILL)
        except (AttributeError, ProcessLookupError):  # Windows has no groups
            program.kill()
        program.communicate()
