"""``igrip view``: playback of a recording in the browser."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import errors, progress, until_interrupted
from igrip.cli.outputs import free_port
from igrip.config import Config
from igrip.errors import RecordingError
from igrip.io.datasets.dataset import Dataset
from igrip.io.recordings import open_source
from igrip.objects.catalog import Catalog, load_objects
from igrip.observation import Observation
from igrip.targets import TARGETS
from igrip.viewer.playback import Player, ReplayWorker, replay_snapshots
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot


def view(
    recording: Annotated[
        Path, typer.Argument(help="A recording (.jsonl, .mcap), or a dataset's folder.")
    ],
    trial: Annotated[
        int, typer.Option(help="Of a dataset: the row of trials.tsv, from 1.", min=1)
    ] = 1,
    targets: options.Targets = None,
    objects: options.Objects = None,
    begin: Annotated[float, typer.Option(help="Start at this time of the recording [s].")] = 0.0,
    duration: Annotated[
        float,
        typer.Option(help="Show at most this many seconds; all are kept in memory.", min=0.0),
    ] = 600.0,
    port: options.PagePort = 8080,
) -> None:
    """Look at a recording in the browser: play, pause, step, and go to any time.

    The page lets you choose another estimator, hand or panel. Ctrl-C ends.

    Example: igrip view near-far --trial 12
    """
    config = Config(targets=targets) if targets else Config()
    TARGETS.get(config.targets)
    port = free_port(port)
    path, catalog = _open(recording, trial, objects or [])
    observations = _read(path, begin + duration)
    snapshots = _replay(path.name, observations, catalog, config, begin)
    first = snapshots[0].t
    worker = ReplayWorker(
        lambda name: replay_snapshots(observations, catalog, Config(targets=name), first)
    )
    viewer = Viewer(port=port, targets=config.targets, choose_targets=worker.request)
    viewer.note(path.name, f"by {config.targets}")
    player = Player(viewer, snapshots)
    worker.start(player.replace, lambda status: viewer.note(path.name, status))
    with closing(viewer), until_interrupted():
        errors.print(f"{path.name} is at {viewer.url}; Ctrl-C ends")
        player.run()


def _open(recording: Path, trial: int, objects: list[str]) -> tuple[Path, Catalog]:
    """Return the recording to show, and the models of its objects."""
    if not recording.is_dir():
        if not recording.exists():
            raise RecordingError(f"{recording}: no such file or folder")
        return recording, load_objects(*(objects or ["ycb"]))
    dataset = Dataset.open(recording)
    if trial > len(dataset.trials):
        raise RecordingError(
            f"{recording} has {len(dataset.trials)} trials, so none number {trial}"
        )
    path = dataset.recording(dataset.trials[trial - 1])
    return path, load_objects(*(objects or dataset.objects))


def _read(path: Path, until: float) -> list[Observation]:
    """Return the messages of a recording up to a time, counted from its first message [s]."""
    messages: list[Observation] = []
    for observation in open_source(path):
        if messages and observation.t - messages[0].t > until:
            errors.print(f"{path.name} goes on; --begin and --duration select what is shown")
            break
        messages.append(observation)
    return messages


def _replay(
    name: str, observations: list[Observation], catalog: Catalog, config: Config, begin: float
) -> list[Snapshot]:
    with progress(f"running {config.targets} over {name}", len(observations)) as update:

        def counted(observation: Observation) -> Observation:
            update(advance=1)
            return observation

        first = observations[0].t + begin if observations else 0.0
        snapshots = replay_snapshots(map(counted, observations), catalog, config, first)
    if not any(snapshot.hands for snapshot in snapshots):
        raise RecordingError(f"{name}: no hand is measured in this part, so nothing can be shown")
    return snapshots
