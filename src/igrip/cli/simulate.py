"""``igrip simulate``: the paper's experiment, or scenes of two hands, with simulated people."""

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
from igrip.lab.simulation.two_hands_cohort import OBJECTS, simulate_two_hands
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
    two_hands: Annotated[
        bool,
        typer.Option(
            "--two-hands",
            help="Instead: passes, handovers, two-handed lifts, and one hand to each of two "
            "objects; 32 scenes of each person, or so many --trials.",
        ),
    ] = False,
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
    parameters, done = cohort_parameters(profile), 0
    workers = Workers(jobs, scheduler, cluster_page)
    steps = (
        simulate_two_hands(
            out, load_objects(*OBJECTS), parameters, participants, seed, trials or None, workers
        )
        if two_hands
        else simulate_cohort(
            out, load_objects("ycb"), parameters, participants, seed, trials or None, no_reach,
            workers,
        )
    )  # fmt: skip
    kept = "nothing was kept" if two_hands else KEPT
    with interruptible(kept), progress(f"simulating {out.name}") as update:
        for done, total in steps:
            update(completed=done, total=total)
    counted = "scenes" if two_hands else "recordings"
    summary = {
        counted: done, "participants": participants, "profile": profile, "seed": seed,
        "parameters": checksum(parameters),
    }  # fmt: skip
    if as_json:
        print_json(summary)
    else:
        output.print(f"{out}: {done} {counted} of {participants} participants ({profile})")
