"""Mutation testing: change the source in small ways and count the changes that no test notices.

Cosmic Ray makes the mutants; a random sample of them runs here, each in a forked process, against
the tests of its package, with kernels in Python. From the root of the repository::

    pip install cosmic-ray==8.7.0
    PYTHONPATH=src python tests/mutation_testing.py src/igrip/motion/*.py --sample 40 --seed 1

Nothing on disk is changed. A mutant that fails a test or takes too long is killed; survivors are
printed as changed lines.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import importlib.abc
import importlib.util
import json
import os
import random
import subprocess
import sys
import time
from pathlib import Path
from types import FunctionType, ModuleType

import pytest

from mutant_sources import by_name, mutants_of, shape

os.environ["NUMBA_DISABLE_JIT"] = "1"
ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"
# the tests of each package or module; those in the file of a module's name run first
TESTS = {
    "motion": ("tests/motion", "tests/golden"),
    "mesh": ("tests/mesh", "tests/geometry"),
    "geometry": ("tests/geometry", "tests/golden", "tests/grips/test_cylinder.py"),
    "cues": ("tests/cues", "tests/golden"),
    "targets": ("tests/targets", "tests/golden"),
    "commitment": (
        "tests/test_commitment.py",
        "tests/test_commitment_borders.py",
        "tests/test_evidence.py",
    ),
    "evidence": ("tests/test_evidence.py",),
    "gating": (
        "tests/test_gating.py",
        "tests/test_gating_borders.py",
        "tests/motion/test_hand_track.py",
    ),
}
ALWAYS = ("tests/test_config.py",)
LEFT_OUT = "test_bayes_real"  # minutes each with kernels in Python


class Module:
    """A module under test, whose functions can be given other code."""

    def __init__(self, path: Path) -> None:
        self.path, self.source = path, path.read_text()
        parts = path.relative_to(SOURCE).with_suffix("").parts
        self.name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        self.label = "/".join(parts[1:])
        self.module: ModuleType = importlib.import_module(self.name)
        original = {
            (code.co_qualname, code.co_firstlineno): key
            for key, code in by_name(compile(self.source, str(path), "exec")).items()
        }
        self.functions = [
            (function, original[function.__code__.co_qualname, function.__code__.co_firstlineno])
            for function in gc.get_objects()
            if isinstance(function, FunctionType)
            and function.__globals__ is self.module.__dict__
            and (function.__code__.co_qualname, function.__code__.co_firstlineno) in original
        ]

    def can_patch(self, mutant: str) -> bool:
        """Whether a mutant differs in bodies of functions alone."""
        return shape(mutant, bodies=False) == shape(self.source, bodies=False)

    def patch(self, mutant: str) -> None:
        """Give the functions of the module the code of a mutant."""
        code = by_name(compile(mutant, str(self.path), "exec"))
        for function, key in self.functions:
            function.__code__ = code[key]

    def change(self, mutant: str) -> str:
        """Return the line that differs, before and after."""
        lines = zip(self.source.splitlines(), mutant.splitlines(), strict=False)
        for number, (old, new) in enumerate(lines, 1):
            if old != new:
                return f"{self.label}:{number}: {old.strip()}  ►  {new.strip()}"
        return f"{self.label}: ?"


class Replacement(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports one module from other source than that on disk."""

    def __init__(self, name: str, path: Path, source: str) -> None:
        self.name, self.path, self.source = name, path, source

    def find_spec(self, name, search, target=None):
        if name != self.name:
            return None
        within = [str(self.path.parent)] if self.path.stem == "__init__" else None
        return importlib.util.spec_from_file_location(
            name, self.path, loader=self, submodule_search_locations=within
        )

    def exec_module(self, module):
        exec(compile(self.source, str(self.path), "exec"), module.__dict__)


class Failures:
    """Counts what does not pass."""

    def __init__(self) -> None:
        self.count = 0

    def pytest_runtest_logreport(self, report):
        self.count += report.failed


class Mutation:
    """Runs mutants where pytest would run the tests that it has collected."""

    def __init__(self, modules: list[Path], options: argparse.Namespace) -> None:
        self.paths, self.options = modules, options
        self.ran = self.survived = 0

    def pytest_runtestloop(self, session):
        items = [item for item in session.items if LEFT_OUT not in item.nodeid]
        seconds = self.measure(items)
        fast = [item for item in items if seconds[item.nodeid] <= self.options.slowest]
        if not fast:
            raise pytest.UsageError("no test passes without a mutant")
        timeout = 10.0 + 20.0 * sum(seconds[item.nodeid] for item in fast)
        for path in self.paths:
            module = Module(path)
            own = f"test_{path.stem}.py"
            order = sorted(fast, key=lambda i: (own not in i.nodeid, seconds[i.nodeid]))
            self.judge(module, order, timeout)
        return True

    def measure(self, items) -> dict[str, float]:
        """Return the processor time of each test [s]; of one that fails it is infinite."""
        reader, writer = os.pipe()
        child = os.fork()
        if not child:
            spent = {}
            for item in items:
                began = time.process_time()
                failed = not passes([item])
                spent[item.nodeid] = 9e9 if failed else time.process_time() - began
            with os.fdopen(writer, "w") as file:
                json.dump(spent, file)
            os._exit(0)
        os.close(writer)
        with os.fdopen(reader) as file:
            seconds = json.load(file)
        os.waitpid(child, 0)
        return seconds

    def judge(self, module: Module, items, timeout: float) -> None:
        """Run a sample of one module's mutants and print the survivors."""
        every = mutants_of(module.path)
        random.Random(f"{self.options.seed} {module.label}").shuffle(every)
        sample = every[: self.options.sample or None]
        survivors = [m for m in sample if self.survives(module, m, items, timeout)]
        lines = [module.change(mutant) for mutant in survivors]
        lines.append(
            f"{module.label}: {len(every)} mutants, {len(sample)} run, {len(survivors)} survived "
            f"({len(items)} tests)"
        )
        with self.options.out.open("a") as file:
            file.write("".join(f"{line}\n" for line in lines))
        self.ran, self.survived = self.ran + len(sample), self.survived + len(survivors)

    def survives(self, module: Module, mutant: str, items, timeout: float) -> bool:
        """Whether all tests pass, in time."""
        if not module.can_patch(mutant):
            names = [item.nodeid for item in items]
            task = json.dumps([module.name, str(module.path), mutant, names])
            command = [sys.executable, __file__, "--one"]
            try:
                done = subprocess.run(command, input=task, text=True, capture_output=True,
                                      cwd=ROOT, timeout=30.0 + timeout, check=False)  # fmt: skip
            except subprocess.TimeoutExpired:
                return False
            return done.returncode == 0
        child = os.fork()
        if not child:
            status = 1
            try:
                module.patch(mutant)
                status = int(not passes(items))
            finally:
                os._exit(status)
        ends = time.monotonic() + timeout
        while time.monotonic() < ends:
            done, status = os.waitpid(child, os.WNOHANG)
            if done:
                return os.waitstatus_to_exitcode(status) == 0
            time.sleep(0.01)
        os.kill(child, 9)
        os.waitpid(child, 0)
        return False


def passes(items) -> bool:
    """Run tests one after the other in this process; return whether all pass."""
    failures = Failures()
    items[0].config.pluginmanager.register(failures)
    for item in items:
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
        if failures.count:
            return False
    return True


QUIET = ("-q", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning")


def one() -> int:
    """Import one module from the source on stdin, and run tests in this process."""
    name, path, source, tests = json.load(sys.stdin)
    sys.meta_path.insert(0, Replacement(name, Path(path), source))
    return int(pytest.main([*QUIET, "-x", *tests]))


def main() -> None:
    """Judge the modules that are named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("modules", nargs="+", type=Path)
    parser.add_argument("--sample", type=int, default=40, help="mutants a module; 0: all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--slowest", type=float, default=1.0, help="leave out slower tests [s]")
    parser.add_argument("--out", type=Path, default=Path("/dev/stdout"))
    options = parser.parse_args()
    families: dict[str, list[Path]] = {}
    for module in options.modules:
        path = module.resolve()
        family = path.relative_to(SOURCE / "igrip").with_suffix("").parts[0]
        families.setdefault(family, []).append(path)
    ran = survived = 0
    for family, paths in families.items():
        mutation = Mutation(paths, options)
        pytest.main([*QUIET, *TESTS[family], *ALWAYS], plugins=[mutation])
        ran, survived = ran + mutation.ran, survived + mutation.survived
    with options.out.open("a") as file:
        file.write(f"{ran} mutants run, {survived} survived: {survived / max(1, ran):.1%}\n")


if __name__ == "__main__":
    sys.exit(one() if sys.argv[1:] == ["--one"] else main())
