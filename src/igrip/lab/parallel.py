"""Work on many items, in this process, in processes of this machine, or on a Dask cluster.

Results come in the order of the items and do not depend on how many workers there are.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import re
import signal
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

from igrip.errors import IgripError, requires_extra

Item = TypeVar("Item")
Result = TypeVar("Result")
MIN_ITEMS = 20  # for each process: it takes seconds to start
MAX_CHUNK = 20  # items sent to a process together: progress should show
WAITING = 4  # chunks on a cluster for each thread: more would only fill its memory
ADDRESS = re.compile(r"(tcp|tls|ucx|wss?)://[^/]+:\d+/?")
CONNECT = 10.0  # s to wait for a scheduler
_work_in_worker: Callable[[Any], Any]  # set in worker processes only


class ClusterError(IgripError):
    """A Dask cluster cannot be used."""


@dataclass(frozen=True)
class Workers:
    """Where work is done.

    Attributes
    ----------
    jobs : int
        Processes of this machine, as of :func:`count_jobs`; with 1 there is none but this one.
    scheduler : str or None
        Address of a Dask scheduler, in place of them, such as ``tcp://10.0.0.1:8786``.
    report : function
        Called with the address of the cluster's page.
    """

    jobs: int = 1
    scheduler: str | None = None
    report: Callable[[str], object] = lambda address: None

    def map(self, work: Callable[[Item], Result], items: Sequence[Item]) -> Iterator[Result]:
        """Yield ``work(item)`` for each item, in order.

        Parameters
        ----------
        work : function
            Can be pickled; it is sent to each worker once, with all that it holds.
        items : sequence
            What it is called with.

        Raises
        ------
        ClusterError
            If there is no scheduler at the address, or its workers die again and again.
        """
        if self.scheduler is not None:
            return _on_cluster(self.scheduler, self.report, work, items)
        return map_in_processes(work, items, self.jobs)


ALONE = Workers()
"""No process but this one."""


def count_jobs(jobs: int, items: int) -> int:
    """Return how many processes to use for items when ``jobs`` are asked for.

    0: one for each processor, as far as there are enough items.
    """
    return max(1, min(jobs or os.cpu_count() or 1, items // MIN_ITEMS))


def map_in_processes(
    work: Callable[[Item], Result], items: Sequence[Item], jobs: int
) -> Iterator[Result]:
    """Yield ``work(item)`` for each item, in order; with 1 job there is no other process."""
    if jobs <= 1:
        yield from map(work, items)
        return
    context = multiprocessing.get_context("spawn")  # forking a process with threads is unsafe
    with ProcessPoolExecutor(jobs, context, _start_worker, (work,)) as pool:
        chunk = max(1, min(MAX_CHUNK, len(items) // (8 * jobs)))
        with _interrupts_ignored():  # Ctrl-C is for this process; the others are started here
            results = pool.map(_work, items, chunksize=chunk)
        try:
            yield from results
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Ignore Ctrl-C within, also in processes that are started there, as long as they live."""
    if threading.current_thread() is not threading.main_thread():
        yield  # other threads are never interrupted
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _start_worker(work: Callable[[Any], Any]) -> None:
    """Keep what all items of a process share: models take time to read."""
    global _work_in_worker
    threading.Thread(target=_end_with_parent, name="igrip-parent", daemon=True).start()
    _work_in_worker = work


def _end_with_parent() -> None:
    """End this process when the one that started it is gone: it would wait for work forever."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _work(item: Any) -> Any:
    return _work_in_worker(item)


def _on_cluster(
    address: str, report: Callable[[str], object], work: Callable[[Item], Result],
    items: Sequence[Item],
) -> Iterator[Result]:  # fmt: skip
    """Yield results of a Dask cluster, in order; a worker that dies costs its chunks' time."""
    with requires_extra("distributed", "cluster", "--scheduler"):
        import distributed
    if ADDRESS.fullmatch(address) is None:
        raise ClusterError(
            f"--scheduler {address}: give the scheduler's own address, tcp://HOST:PORT; http:// is "
            "its page"
        )
    try:
        client: Any = distributed.Client(  # type: ignore[no-untyped-call]
            address, timeout=CONNECT, set_as_default=False
        )
    except (OSError, ValueError, TimeoutError) as error:
        raise ClusterError(
            f"--scheduler {address}: there is no Dask scheduler: {error}; start one by "
            "'dask scheduler', and workers by 'dask worker ADDRESS'"
        ) from error
    with client, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the work may hold megabytes of meshes
        report(client.dashboard_link)
        # a task, not scattered data: the scheduler makes it again when a worker dies
        held = client.submit(pickle.loads, pickle.dumps(work))
        chunks = [items[k : k + MAX_CHUNK] for k in range(0, len(items), MAX_CHUNK)]
        waiting: deque[Any] = deque()
        try:
            for number, chunk in enumerate(chunks):
                waiting.append(
                    client.submit(_work_on_chunk, held, chunk, pure=False, priority=-number)
                )
                # workers may join and leave meanwhile
                while len(waiting) >= WAITING * max(1, sum(client.nthreads().values())):
                    yield from waiting.popleft().result()
            while waiting:
                yield from waiting.popleft().result()
        except distributed.KilledWorker as error:
            raise ClusterError(f"--scheduler {address}: {error}") from error
        finally:
            client.cancel(list(waiting))


def _work_on_chunk(work: Callable[[Item], Result], chunk: Sequence[Item]) -> list[Result]:
    return [work(item) for item in chunk]
