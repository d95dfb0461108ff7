"""Work in processes and on a Dask cluster: order, kills, and the same results however many."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from igrip import Config, load_objects
from igrip.lab import parallel
from igrip.lab.benchmark.entries import parse_entry
from igrip.lab.benchmark.run import run_entry
from igrip.lab.benchmark.sets import open_set
from igrip.lab.evaluation.runner import run_trials
from igrip.lab.evaluation.trial_rows import score_run
from igrip.lab.parallel import ALONE, ClusterError, Workers, count_jobs
from igrip.lab.simulation.cohort import simulate_cohort
from igrip.lab.simulation.parameters import cohort_parameters
from igrip.lab.tuning.replays import Replays
from runtime_fakes import until

SLOWER = {"motion.reach.time_constant": 0.1}


def test_processes_are_spawned_and_get_trials_in_chunks(monkeypatch):
    made = []

    class Pool:
        """A pool of processes that are this one."""

        def __init__(self, jobs, context, initializer, initargs):
            made.append((jobs, context.get_start_method()))
            initializer(*initargs)

        def __enter__(self):
            return self

        def __exit__(self, *error):
            made.append("closed")

        def map(self, function, items, chunksize):
            made.append(chunksize)
            return map(function, items)

    monkeypatch.setattr(parallel, "ProcessPoolExecutor", Pool)

    def run(count, jobs=1):
        made.clear()
        assert list(Workers(jobs).map(int, list(range(count)))) == list(range(count))
        return list(made)

    assert run(3) == run(3, jobs=0) == []
    assert run(3, jobs=2) == [(2, "spawn"), 1, "closed"]
    assert run(64, jobs=2)[1] == 4
    assert run(1000, jobs=3)[1] == 20


def test_number_of_processes(monkeypatch):
    monkeypatch.setattr(parallel.os, "cpu_count", lambda: 8)
    assert [count_jobs(0, n) for n in (0, 39, 40, 100, 10_000)] == [1, 1, 2, 5, 8]
    assert [count_jobs(3, n) for n in (0, 39, 40, 100)] == [1, 1, 2, 3]
    monkeypatch.setattr(parallel.os, "cpu_count", lambda: None)
    assert count_jobs(0, 1000) == 1


KILLED = """
import multiprocessing, os, signal, sys
from igrip import Config, load_objects
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation.runner import run_trials
from igrip.lab.evaluation.trial_rows import score_run
from igrip.lab.parallel import Workers

if __name__ == "__main__":
    dataset = Dataset.open(sys.argv[1])
    catalog = load_objects(*dataset.objects)
    configs = [Config(targets="distance")]
    for _ in run_trials(dataset, catalog, configs, score_run, dataset.trials * 30, Workers(2)):
        print(*(child.pid for child in multiprocessing.active_children()), flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
"""


def test_processes_end_when_the_one_that_started_them_is_killed(small_dataset, tmp_path):
    script = tmp_path / "killed.py"
    script.write_text(KILLED)
    command = [sys.executable, str(script), str(small_dataset.path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        workers = [int(pid) for pid in process.stdout.readline().split()]
        assert len(workers) == 2
        process.stdout.read()  # the workers hold this pipe, too: it ends with the last of them
    assert process.returncode == -signal.SIGKILL
    if Path("/proc/self").exists():
        for pid in workers:
            until(lambda pid=pid: not Path(f"/proc/{pid}").exists())


def test_a_cluster_gives_the_same_rows_though_a_worker_is_killed(small_dataset, cluster):
    address, workers, one = cluster
    catalog = load_objects(*small_dataset.objects)
    configs, trials = [Config(targets="distance")], list(small_dataset.trials) * 100
    alone = list(run_trials(small_dataset, catalog, configs, score_run, trials))
    pages = []
    together = run_trials(
        small_dataset, catalog, configs, score_run, trials,
        Workers(scheduler=address, report=pages.append),
    )  # fmt: skip
    found = [next(together)]
    workers[0].kill()  # in the middle of its work
    workers.append(subprocess.Popen(one, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
    found += together
    assert json.dumps(found) == json.dumps(alone)
    assert len(pages) == 1


def test_a_cluster_simulates_the_same_people(ycb, cluster, tmp_path):
    written = []
    for workers in (ALONE, Workers(scheduler=cluster[0])):
        folder = tmp_path / str(len(written))
        list(simulate_cohort(folder, ycb, cohort_parameters(), 1, 0, 3, 1, workers))
        written.append({path.relative_to(folder): path.read_bytes()
                        for path in sorted(folder.rglob("*")) if path.is_file()})  # fmt: skip
    assert written[0] == written[1]


def test_a_cluster_replays_the_same_trials_for_a_tuning(small_dataset, cluster):
    catalog = load_objects(*small_dataset.objects)
    found = []
    for workers in (ALONE, Workers(scheduler=cluster[0])):
        replays = Replays(small_dataset, catalog, Config(), small_dataset.trials, workers)
        found.append([np.array(replays.outcomes(values)).tolist() for values in ({}, SLOWER)])
    assert np.isfinite(found[0][0][0]).all()  # every trial has its commitment
    assert json.dumps(found[0]) == json.dumps(found[1])


def test_a_cluster_judges_an_entry_alike(small_dataset, cluster, tmp_path):
    catalog = load_objects(*small_dataset.objects)
    judged = open_set("small", small_dataset.path)
    found = []
    for workers in (ALONE, Workers(scheduler=cluster[0])):
        (out := tmp_path / f"judged{len(found)}").mkdir()
        rows = list(run_entry(parse_entry("distance"), judged, catalog, out, workers))
        found.append([{k: v for k, v in row.items() if k != "ms"} for row in rows])
    assert [row["success"] for row in found[0]] == [True] * len(judged.trials)
    assert json.dumps(found[0]) == json.dumps(found[1])


@pytest.mark.parametrize("address", ["http://127.0.0.1:8787", "tcp://127.0.0.1", "foo://x:1", "x"])
def test_what_is_no_address_of_a_scheduler(address):
    pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    with pytest.raises(ClusterError, match="give the scheduler's own address"):
        list(Workers(scheduler=address).map(int, ["1"]))


def test_an_error_of_the_work_reaches_the_caller(cluster):
    with pytest.raises(ValueError, match="invalid literal"):
        list(Workers(scheduler=cluster[0]).map(int, ["1", "x"]))


def test_no_scheduler_is_named(monkeypatch):
    pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    monkeypatch.setattr(parallel, "CONNECT", 0.5)
    with pytest.raises(ClusterError, match=r"tcp://127.0.0.1:1: there is no Dask scheduler"):
        list(Workers(scheduler="tcp://127.0.0.1:1").map(int, ["1"]))
