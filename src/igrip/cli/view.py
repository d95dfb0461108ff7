"""``igrip view``: playback of a recording in the browser."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Annotated, Any, NamedTuple

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

TRIAL_COLUMNS = ("participant", "trial", "hand", "target", "grip", "movement", "camera_side")


class Choice(NamedTuple):
    """What is shown: the row of a trial, from 1, and the estimator."""

    trial: int
    targets: str
    title: str

    def __str__(self) -> str:
        return f"{self.title}, by {self.targets}"


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

    It begins to play shortly before the first decision. The page lets you choose another
    estimator and, of a dataset, another trial. Ctrl-C ends.

    Example: igrip view near-far --trial 12
    """
    name = targets or Config().targets
    TARGETS.get(name)
    port = free_port(port)
    dataset = _open(recording, trial)
    path = _path(recording, dataset, trial)
    sources = objects or (dataset.objects if dataset else ["ycb"])
    catalog = load_objects(*sources)
    observations = _read(path, begin + duration)
    snapshots = _replay(path.name, observations, catalog, Config(targets=name), begin)
    shown = [Choice(trial, name, _title(dataset, trial, path))]

    def replay(choice: Choice) -> list[Snapshot]:
        messages = _read(_path(recording, dataset, choice.trial), begin + duration)
        first = messages[0].t + begin if messages else 0.0
        snapshots = replay_snapshots(messages, catalog, Config(targets=choice.targets), first)
        _check_hands(snapshots, choice.title)
        return snapshots

    worker = ReplayWorker(replay)
    viewer = Viewer(
        port=port, targets=name,
        choose_targets=lambda name: worker.request(shown[0]._replace(targets=name)),
    )  # fmt: skip
    player = Player(viewer, snapshots)

    def choose_trial(number: int) -> None:
        if dataset is not None and 1 <= number <= len(dataset.trials):
            title = _title(dataset, number, _path(recording, dataset, number))
            worker.request(shown[0]._replace(trial=number, title=title))

    def show(choice: Choice, snapshots: list[Snapshot]) -> None:
        anew = choice.trial != shown[0].trial
        shown[0] = choice
        player.replace(snapshots, anew)
        viewer.publish("trial", {"number": choice.trial})

    viewer.note("", str(shown[0]))
    if dataset is not None:
        viewer.handle("trial", lambda number: choose_trial(int(number)))
        viewer.publish("trials", list_trials(dataset))
        viewer.publish("trial", {"number": trial})
    worker.start(show, lambda status: viewer.note("", status))
    with closing(viewer), until_interrupted():
        errors.print(f"{path.name} is at {viewer.url}; Ctrl-C ends")
        player.run()


def list_trials(dataset: Dataset) -> dict[str, Any]:
    """Return the table of trials for the page; their numbers begin at 1."""
    rows = [
        [k, *(getattr(trial, column) for column in TRIAL_COLUMNS)]
        for k, trial in enumerate(dataset.trials, start=1)
    ]
    columns = ["number", *(column.replace("_", " ") for column in TRIAL_COLUMNS)]
    return {"columns": columns, "rows": rows}


def _title(dataset: Dataset | None, number: int, path: Path) -> str:
    """Return the name of a recording, and its task."""
    if dataset is None:
        return path.name
    trial = dataset.trials[number - 1]
    parts = [f"trial {number} ({path.name})"]
    if trial.hand:
        parts.append(f"task: {trial.hand} hand to {trial.target or 'unknown'}")
    return ", ".join(parts)


def _open(recording: Path, trial: int) -> Dataset | None:
    """Return the dataset that has this trial; None for a single recording."""
    if not recording.exists():
        raise RecordingError(f"{recording}: no such file or folder")
    if not recording.is_dir():
        return None
    dataset = Dataset.open(recording)
    if trial > len(dataset.trials):
        raise RecordingError(
            f"{recording} has {len(dataset.trials)} trials, so none number {trial}"
        )
    return dataset


def _path(recording: Path, dataset: Dataset | None, trial: int) -> Path:
    return recording if dataset is None else dataset.recording(dataset.trials[trial - 1])


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
    _check_hands(snapshots, name)
    return snapshots


def _check_hands(snapshots: list[Snapshot], name: str) -> None:
    if not any(snapshot.hands for snapshot in snapshots):
        raise RecordingError(f"{name}: no hand is measured in this part, so nothing can be shown")
