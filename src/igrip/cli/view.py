"""``igrip view``: a recording in the browser, to be played, stepped and searched."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.console import errors, progress
from igrip.config import Config
from igrip.errors import RecordingError
from igrip.io.datasets.dataset import Dataset
from igrip.io.recordings import open_source
from igrip.objects.catalog import Catalog, load_objects
from igrip.observation import Observation
from igrip.targets import TARGETS
from igrip.viewer.playback import Player, ReplayWorker, make_film
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot


def view(
    recording: Annotated[
        Path, typer.Argument(help="A recording (.jsonl, .mcap), or a dataset's folder.")
    ],
    trial: Annotated[
        int, typer.Option(help="Of a dataset: which row of trials.tsv, from 1 on.", min=1)
    ] = 1,
    targets: Annotated[
        str | None, typer.Option(help="Targets estimator. Default: the library's.")
    ] = None,
    objects: Annotated[
        list[str] | None,
        typer.Option(help="Where models come from, in place of the dataset's own or of ycb."),
    ] = None,
    begin: Annotated[float, typer.Option(help="From this time of the recording on [s].")] = 0.0,
    duration: Annotated[
        float,
        typer.Option(help="At most so many seconds; all are kept in memory.", min=0.0),
    ] = 600.0,
    port: Annotated[int, typer.Option(help="Port of the page.", min=1, max=65535)] = 8080,
) -> None:
    """Look at a recording in the browser: play, pause, step, and go to any moment.

    Another estimator, hand or panel is chosen on the page. Ctrl-C ends.

    Example: igrip view near-far --trial 12
    """
    config = Config(targets=targets) if targets else Config()
    TARGETS.get(config.targets)
    path, catalog = _open(recording, trial, objects or [])
    observations = _read(path, begin + duration)
    film = _film(path.name, observations, catalog, config, begin)
    cutter = ReplayWorker(
        lambda name: make_film(observations, catalog, Config(targets=name), film[0].t)
    )
    viewer = Viewer(port=port, targets=config.targets, choose_targets=cutter.want)
    viewer.note(path.name, f"by {config.targets}")
    player = Player(viewer, film)
    cutter.start(player.take, lambda text: viewer.note(path.name, text))
    try:
        errors.print(f"{path.name} is at {viewer.url}; Ctrl-C ends")
        player.run()
    except KeyboardInterrupt:
        errors.print("stopped")
    finally:
        viewer.close()


def _open(recording: Path, trial: int, objects: list[str]) -> tuple[Path, Catalog]:
    """Return the recording to look at, and the models of its objects."""
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
            errors.print(f"{path.name} goes on; --begin and --duration choose what is shown")
            break
        messages.append(observation)
    return messages


def _film(
    name: str, observations: list[Observation], catalog: Catalog, config: Config, begin: float
) -> list[Snapshot]:
    with progress() as bar:
        task = bar.add_task(f"running {config.targets} over {name}", total=len(observations))

        def counted(observation: Observation) -> Observation:
            bar.advance(task)
            return observation

        first = observations[0].t + begin if observations else 0.0
        film = make_film(map(counted, observations), catalog, config, first)
    if not any(moment.hands for moment in film):
        raise RecordingError(f"{name}: no hand is measured in this part, so nothing can be shown")
    return film
