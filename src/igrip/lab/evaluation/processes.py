"""Work over many recordings, in parallel processes."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")
MAX_AT_ONCE = 20  # jobs handed to a process together: progress should show


def in_processes(
    function: Callable[[Job], Result], work: Sequence[Job], jobs: int
) -> Iterator[Result]:
    """Yield the results of a function over jobs, in order.

    Parameters
    ----------
    function : function
        At the top level of a module, so that another process finds it.
    work : sequence
        What it is called with.
    jobs : int
        Number of processes; with 1 there is no other.
    """
    if jobs <= 1:
        yield from map(function, work)
        return
    context = multiprocessing.get_context("spawn")  # forking a process with threads is unsafe
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        chunk = max(1, min(MAX_AT_ONCE, len(work) // (8 * jobs)))
        yield from pool.map(function, work, chunksize=chunk)
