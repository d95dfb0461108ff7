"""``igrip tune``: the configuration of one person, from their own trials."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated, Any

import typer

from igrip.cli import options
from igrip.cli.console import cluster_page, errors, output, print_json, progress, table_of, warn
from igrip.cli.estimator_setup import base_config
from igrip.errors import DatasetError, requires_extra
from igrip.io.datasets.shared import open_dataset
from igrip.lab.evaluation.fingerprint import fingerprint
from igrip.lab.parallel import Workers
from igrip.lab.tuning.files import Subject, record_of, write_files
from igrip.lab.tuning.page import write_page
from igrip.lab.tuning.replays import Replays, choose_trials, people_of
from igrip.lab.tuning.search import open_storage
from igrip.lab.tuning.space import SPACE, first_candidates
from igrip.lab.tuning.tuning import MIN_REACHES, Tuning
from igrip.objects.catalog import load_objects


def tune(
    dataset: Annotated[Path, typer.Argument(help="A dataset's folder.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the results.")],
    participant: Annotated[
        list[str] | None,
        typer.Option(help="Whose trials; several make a cohort. Default: everyone."),
    ] = None,
    config: options.ConfigFile = None,
    targets: options.Targets = None,
    objects: options.Objects = None,
    limit: Annotated[
        int, typer.Option(help="Trials of each person, evenly spread over theirs; 0: all.", min=0)
    ] = 50,
    trials: Annotated[
        int, typer.Option(help="Candidates of each search, at most.", min=1)
    ] = 100,
    timeout: Annotated[
        float | None,
        typer.Option(help="Seconds for the searches; what is found then depends on the machine.",
                     min=0),
    ] = None,
    seed: options.Seed = 0,
    jobs: options.Jobs = 0,
    scheduler: options.Scheduler = None,
    as_json: options.Json = False,
) -> None:  # fmt: skip
    """Tune commitments to one person, from 8 to 50 of their trials, or to a cohort.

    Inner folds choose and outer folds judge. Without a gain on trials that were not seen, the
    configuration stays as it is. DIR/config.toml is for --config of the other commands, and
    DIR/tune.html shows what else there is to choose from.

    An interrupted tuning continues where it stopped when the command is run again.

    Example: igrip tune near-far --participant sub-033 --out tuned
    """
    with requires_extra("optuna", "tune", "tuning"):
        import optuna  # noqa: F401
    present = base_config(config, targets)
    opened = open_dataset(dataset, lenient=True)
    people = list(dict.fromkeys(participant or people_of(opened)))
    chosen = choose_trials(opened, people, limit)
    if len(chosen) < MIN_REACHES:
        raise DatasetError(
            f"{dataset}: tuning needs at least {MIN_REACHES} trials of {', '.join(people)}, "
            f"there are {len(chosen)}"
        )
    sources = tuple(objects or opened.objects)
    catalog = load_objects(*sources)
    name = hashlib.sha256(fingerprint(opened, [present], sources).encode())
    for trial in chosen:
        name.update(f"{trial.recording} {opened.stamp(trial)}\n".encode())
    out.mkdir(parents=True, exist_ok=True)
    storage = open_storage(out / "study.db")
    with errors.status(f"replaying {len(chosen)} trials …"):
        replays = Replays(opened, catalog, present, chosen, Workers(jobs, scheduler, cluster_page))
    for one in replays.unusable:
        warn(f"left out {one.recording}: {one.problem}")
    cohort = len(people) > 1
    groups = [one.participant if cohort else one.recording for one in replays.usable]
    tuning = Tuning(
        replays.outcomes, groups, SPACE, first_candidates(present), seed=seed, limit=trials,
        cohort=cohort, name=name.hexdigest()[:16], storage=storage,
    )  # fmt: skip
    _search(tuning, trials, timeout, f"tuning {', '.join(people):.40}", out)
    decision = tuning.decide()
    subject = Subject(opened.name, people, replays.usable, replays.unusable, present, seed)
    record = record_of(subject, tuning, decision)
    write_files(out, subject, decision, record)
    page = write_page(out, record)
    if as_json:
        print_json(record)
    else:
        _print(record, page)


def _search(tuning: Tuning, trials: int, timeout: float | None, label: str, out: Path) -> None:
    """Run the searches; at Ctrl-C, what is done is kept."""
    most = trials * len(tuning.searches)
    done = 0
    try:
        with progress(label, most) as update:
            for done in tuning.run(timeout):
                update(completed=done)
            update(completed=most)
    except KeyboardInterrupt:
        errors.print(
            f"stopped after {done} of at most {most} candidates; the same command continues there "
            f"({out / 'study.db'})", soft_wrap=True,
        )  # fmt: skip
        raise typer.Exit(130) from None
    if not tuning.is_complete:
        warn("the time limit ended the searches; the same command continues them")


def _print(record: dict[str, Any], page: Path) -> None:
    from igrip.lab.tuning.page import percent, rate

    columns = ("on unseen trials", "committed", "right", "at part", "false / min")
    rows = [
        (label, percent(row["committed"]), percent(row["right"]), percent(row["part"]),
         rate(row["false_per_minute"]))
        for label, row in (("as it was", record["present"]), ("as found", record["unseen"]))
    ]  # fmt: skip
    output.print(table_of(columns, rows))
    low, high = record["gain_interval"]
    gain = f"gain in value {record['gain']:+.3f}, 95 % interval {low:+.3f} to {high:+.3f}"
    output.print(f"{gain} ({record['reaches']} reaches)", soft_wrap=True)
    verdict = "tuned" if record["tuned"] else "keep the default"
    output.print(f"{verdict}: {record['reason']}", soft_wrap=True)
    output.print(f"{page.parent / 'config.toml'}; to choose yourself: {page}", soft_wrap=True)
