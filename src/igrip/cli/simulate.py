"""``igrip simulate``: the paper's experiment with simulated people, as a dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import (
    cluster_page,
    interruptible,
    output,
    print_json,
    progress,
)
from igrip.cli.outputs import folder_option
from igrip.lab.parallel import Workers
from igrip.lab.simulation.cohort import simulate_cohort
from igrip.lab.simulation.parameters import PROFILES, checksum, cohort_parameters
from igrip.objects.catalog import load_objects

KEPT = "what is done is kept; the same command goes on from there"


def simulate(
    out: Annotated[
        Path,
        typer.Argument(help="A new folder for the dataset.", callback=folder_option(new=True)),
    ],
    participants: Annotated[int, typer.Option(help="Number of people.", min=1)] = 11,
    seed: options.Seed = 0,
    profile: Annotated[str, typer.Option(help=f"{', '.join(PROFILES)}.")] = "healthy",
    trials: Annotated[
        int, typer.Option(help="Simulate only this many trials of each; 0: all 128.", min=0)
    ] = 0,
    no_reach: Annotated[
        int, typer.Option(help="Minutes without a reach, one recording each.", min=0)
    ] = 30,
    jobs: options.Jobs = 0,
    scheduler: options.Scheduler = None,
    as_json: options.Json = False,
) -> None:
    """Simulate the paper's protocol: people × 128 trials × 2 cameras, in random order.

    An interrupted simulation continues where it stopped when the command is run again.

    Every effect size and its source are listed in igrip/lab/simulation/parameters.py.

    Example: igrip simulate cohort --participants 11 --seed 0
    """
    parameters, catalog = cohort_parameters(profile), load_objects("ycb")
    done = 0
    with interruptible(KEPT), progress(f"simulating {out.name}") as update:
        for done, total in simulate_cohort(
            out,
            catalog,
            parameters,
            participants,
            seed,
            trials or None,
            no_reach,
            Workers(jobs, scheduler, cluster_page),
        ):
            update(completed=done, total=total)
    summary = {"recordings": done, "participants": participants, "profile": profile, "seed": seed,
               "parameters": checksum(parameters)}  # fmt: skip
    if as_json:
        print_json(summary)
    else:
        output.print(f"{out}: {done} recordings of {participants} participants ({profile})")
