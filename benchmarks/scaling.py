"""What a trial costs, how two workers share it, and that memory does not grow with trials.

``python -m benchmarks.scaling --many 100000`` prints the table of docs/cluster.md. It simulates a
cohort and evaluates it alone and on a Dask cluster of one and of two workers, then evaluates a
dataset of very many short recordings and reads its own memory meanwhile.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from igrip.config import Config
from igrip.io.datasets.dataset import Dataset
from igrip.io.datasets.writer import DatasetWriter
from igrip.lab.evaluation.evaluation import Evaluation
from igrip.lab.parallel import ALONE, Workers
from igrip.lab.simulation.cohort import simulate_cohort
from igrip.lab.simulation.parameters import cohort_parameters
from igrip.lab.speed.measure import resident_memory
from igrip.objects.catalog import load_objects

BAYES = Config(targets="bayes")


@contextmanager
def workers_of(count: int) -> Iterator[Workers]:
    """Start a Dask cluster of so many processes; 0: none, this process works alone."""
    if not count:
        yield ALONE
        return
    import distributed

    with distributed.LocalCluster(  # type: ignore[no-untyped-call]
        n_workers=count, threads_per_worker=1, dashboard_address=None
    ) as cluster:
        yield Workers(scheduler=cluster.scheduler_address)


def simulate(folder: Path, trials: int, workers: Workers) -> float:
    """Return how long it takes to simulate the trials of one person [s]."""
    begun = time.perf_counter()
    for _ in simulate_cohort(
        folder, load_objects("ycb"), cohort_parameters(), 1, 0, trials, 0, workers
    ):
        pass
    return time.perf_counter() - begun


def evaluate(dataset: Dataset, out: Path, workers: Workers) -> float:
    """Return how long it takes to evaluate ``bayes`` over a dataset [s]."""
    evaluation = Evaluation(dataset, [BAYES], out)
    begun = time.perf_counter()
    for _ in evaluation.run(dataset.trials, workers):
        pass
    return time.perf_counter() - begun


def many_trials(source: Dataset, folder: Path, count: int, seconds: float = 1.5) -> Dataset:
    """Write a dataset whose trials are all the same short stretches, as links to few files."""
    few = source.trials[:8]
    with DatasetWriter(folder, "many", "CC0-1.0", "links", objects=["ycb"]) as writer:
        for trial in few:
            end = trial.end_s or 0.0
            writer.add(trial, (m for m in source.observations(trial) if abs(m.t - end) < seconds))
        written = writer.close()
    trials = []
    for k in range(count):
        trial = few[k % len(few)]
        name = f"{k:07d}"
        os.link(written.recording(trial), folder / "recordings" / f"{name}.jsonl")
        trials.append(replace(trial, recording=name))
    return replace(written, trials=tuple(trials))


def memory_over(dataset: Dataset, out: Path, parts: int = 10) -> list[float]:
    """Return the memory of this process [MB] after each part of an evaluation."""
    evaluation = Evaluation(dataset, [BAYES], out)
    found = []
    for done in evaluation.run(dataset.trials, ALONE):
        if done and done % max(1, len(dataset.trials) // parts) == 0:
            found.append(resident_memory())
    return found


def main(
    trials: Annotated[int, typer.Option(help="Trials of one person, two cameras each.")] = 96,
    many: Annotated[int, typer.Option(help="Trials of the test of memory.")] = 10_000,
) -> None:
    """Print costs and ratios, all of one run."""
    folder = Path(tempfile.mkdtemp())
    try:
        simulate(folder / "warm", 1, ALONE)
        evaluate(Dataset.open(folder / "warm"), folder / "warm-out", ALONE)
        times = {}
        for count in (0, 1, 2):
            with workers_of(count) as workers:
                made = folder / f"cohort{count}"
                if count:  # a worker's first trials load and compile
                    simulate(folder / f"warm{count}", 2 * count * 20, workers)
                    evaluate(Dataset.open(folder / f"warm{count}"), folder / f"w{count}", workers)
                simulated = simulate(made, trials, workers)
                evaluated = evaluate(Dataset.open(made), folder / f"out{count}", workers)
            times[count] = (simulated, evaluated)
            costs = [1e3 * t / (2 * trials) for t in times[count]]
            where = f"{count} workers" if count else "this process"
            print(f"{where}: simulate {costs[0]:.1f} ms, evaluate {costs[1]:.1f} ms a recording")
        for k, what in enumerate(("simulate", "evaluate")):
            print(f"{what}: 2 workers are {times[1][k] / times[2][k]:.2f} x as fast as 1")
        memory = memory_over(many_trials(Dataset.open(folder / "cohort0"), folder / "many", many),
                             folder / "many-out")  # fmt: skip
        print(f"memory over {many} trials [MB]:", *(f"{m:.0f}" for m in memory))
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    typer.run(main)
