"""``igrip experiment``: studies with people, from the plan to a dataset."""

from __future__ import annotations

import time
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Annotated, Any

import typer

from igrip.cli import options
from igrip.cli.console import (
    errors,
    inform,
    interruptible,
    output,
    print_json,
    progress,
    table_of,
    until_interrupted,
)
from igrip.cli.outputs import free_port
from igrip.config import Config
from igrip.errors import IgripError
from igrip.experiment.conductor import Conductor
from igrip.experiment.folder import StudyFolder, new_study
from igrip.experiment.lsl_markers import LslMarkers
from igrip.experiment.object_pictures import object_picture
from igrip.experiment.open_cameras import open_recorder, parse_cameras
from igrip.experiment.participant_summary import write_summary
from igrip.experiment.review import Review
from igrip.experiment.review_page import ReviewPage
from igrip.experiment.screens import Screens
from igrip.experiment.session import Session
from igrip.experiment.simulated import SimulatedRecorder
from igrip.experiment.study import TEMPLATES, read_instructions
from igrip.experiment.unattended import run_unattended
from igrip.runtime.access import Access

experiment = typer.Typer(
    help="Run a study with people: plan, screens, recordings, and a dataset for igrip evaluate."
    "\n\nExample: igrip experiment new my-study --template paper",
    no_args_is_help=True, add_completion=False, rich_markup_mode=None,
)  # fmt: skip

STEP = 0.02  # s between two looks at what was ordered
Folder = Annotated[Path, typer.Argument(help="Folder of the study.")]


@experiment.command()
def new(
    folder: Folder,
    template: Annotated[str, typer.Option(help=f"{', '.join(TEMPLATES)}.")] = "paper",
) -> None:
    """Write a study file to begin with.

    Example: igrip experiment new my-study --template paper
    """
    new_study(folder, template)
    study = StudyFolder(folder).study
    output.print(
        f"{folder}/study.toml: {study.trial_count} trials for each participant; edit it, then: "
        f"igrip experiment run {folder} --participant P01 --consent DATE",
        soft_wrap=True,
    )


@experiment.command()
def run(
    folder: Folder,
    participant: Annotated[
        str, typer.Option(help="Pseudonym, such as P01; the same one goes on where it stopped.")
    ],
    consent: Annotated[
        str | None, typer.Option(help="Date of the consent, 2026-01-31; needed the first time.")
    ] = None,
    camera: Annotated[
        list[str] | None,
        typer.Option(help="NAME=ADDRESS of each camera of the study, such as left=oak:ID1."),
    ] = None,
    hands: Annotated[str, typer.Option(help="Hand detector.")] = "mediapipe",
    poses: Annotated[str, typer.Option(help="Pose estimator: depth, tags, cosypose.")] = "depth",
    calibration: options.Calibration = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="A simulated person and simulated cameras.")
    ] = False,
    unattended: Annotated[
        bool, typer.Option("--unattended", help="With --simulate: all trials, without screens.")
    ] = False,
    lsl: Annotated[
        str | None,
        typer.Option(help="Name of an LSL stream of markers, for the laboratory's recorders."),
    ] = None,
    port: Annotated[int, typer.Option(help="Of the screens; 0: any that is free.", min=0,
                                      max=65535)] = 8095,
    host: options.PageHost = "127.0.0.1",
    token: options.Token = None,
) -> None:  # fmt: skip
    """Run the trials of one participant, or go on with them.

    After a crash, or on the next day, the same command goes on where it stopped.

    Two pages: the experimenter's, and /participant for a second monitor or computer. Keys: space
    starts and stops, R repeats the last trial, W marks it as wrong, C comments on it, E ends a
    break, F ends the session. A foot switch that sends space is a start button.

    Example: igrip experiment run my-study --participant P01 --consent 2026-01-31 --camera
    left=oak:ID1 --camera right=oak:ID2

    Example, with nobody there: igrip experiment run my-study --participant P01 --consent
    2026-01-31 --simulate
    """
    place = StudyFolder(folder)
    words = read_instructions(folder, place.study.language)
    if unattended and not simulate:
        raise IgripError("--unattended needs --simulate: people are not left alone with it")
    addresses = {} if simulate else parse_cameras(place.study, camera or [])
    if not unattended:
        port = free_port(port, "--port", host)
        Access(host, token)  # refused before anything slow is loaded
    with place.locked(), ExitStack() as stack:
        place.check(participant, consent)
        with (
            interruptible("no trial was begun; the same command starts again"),
            errors.status("Reading meshes, models and compiling (longer the first time) …"),
        ):
            catalog = place.catalog()
            recorder: Any = (
                SimulatedRecorder(place.study, catalog, participant) if simulate
                else open_recorder(place.study, addresses, catalog, hands, poses, calibration)
            )  # fmt: skip
        stack.callback(recorder.close)
        plan = place.enrol(participant, consent)
        announce = None
        if lsl is not None:
            markers = LslMarkers(lsl, place.study.name, participant)
            stack.callback(markers.close)
            announce = markers.send
        session = Session(place, plan, recorder, announce=announce or (lambda event: None))
        stack.callback(session.close)
        for remark in session.remarks:
            inform(remark)
        with interruptible(lambda: _kept(session, folder)):
            if unattended:
                with progress(participant) as update:
                    for done, total in run_unattended(session):
                        update(completed=done, total=total)
            else:
                conductor = Conductor(session, words, recorder.seen)
                pictures = {
                    id: object_picture(catalog[one.model], one.colour)
                    for id, one in place.study.objects.items()
                }
                screens = Screens(conductor, pictures, recorder.picture, port, host, token)
                stack.callback(screens.close)
                suffix = f"?token={token}" if token else ""
                inform(f"experimenter: {screens.url}/{suffix}")
                inform(f"participant:  {screens.url}/participant{suffix}")
                while not conductor.finished:
                    conductor.step()
                    time.sleep(STEP)
    output.print(f"{participant}: {len(session.progress.done)} of {len(plan.trials)} trials")
    if session.progress.done:
        with place.locked():
            _summarise(place, participant)
    inform(f"Next: igrip experiment review {folder} --participant {participant}")


def _summarise(place: StudyFolder, participant: str) -> None:
    """Write and name the page on one participant."""
    catalog = place.catalog()
    kept = "the recordings are kept; igrip experiment summary writes the page again"
    with (
        closing(Review(place, participant)) as found, interruptible(kept),
        progress(f"summary of {participant}", 2 * len(found)) as update,
    ):  # fmt: skip
        found.read(lambda: update(advance=1))
        path = write_summary(place, found, catalog, Config(), lambda: update(advance=1))
    output.print(f"{path}", soft_wrap=True)


def _kept(session: Session, folder: Path) -> str:
    following = session.next_trial
    where = "all trials are done" if following is None else (
        f"the same command goes on at trial {following.number}"
    )  # fmt: skip
    return f"every finished trial is kept in {folder}; {where}"


@experiment.command()
def review(
    folder: Folder,
    participant: Annotated[str, typer.Option(help="Whose recordings.")],
    port: Annotated[int, typer.Option(help="Of the page; 0: any that is free.", min=0,
                                      max=65535)] = 8096,
    host: options.PageHost = "127.0.0.1",
    token: options.Token = None,
) -> None:  # fmt: skip
    """Look at recordings, and correct them.

    Onset, end and "did as told" of a participant's trials are corrected by mouse or key.

    The page shows each recording's speed profile, its view from above and its video, with onset,
    end and validity as they were found. Every change is kept at once, logged in
    sessions/PARTICIPANT/review.jsonl and written into trials.tsv. Ctrl-C ends.

    Example: igrip experiment review my-study --participant P01
    """
    place = StudyFolder(folder)
    port = free_port(port, "--port", host)
    Access(host, token)  # refused before anything slow is read
    with place.locked(), closing(Review(place, participant)) as found:
        with interruptible("nothing was changed"), progress(participant, len(found)) as update:
            found.read(lambda: update(advance=1))
        page = ReviewPage(found, port, host, token)
        with closing(page), until_interrupted("every correction is kept"):
            inform(f"review: {page.url}/{f'?token={token}' if token else ''}; Ctrl-C ends")
            while True:
                time.sleep(1.0)


@experiment.command()
def summary(
    folder: Folder, participant: Annotated[str, typer.Option(help="Whom it is about.")]
) -> None:
    """Write the page on one participant.

    It has trials, validity, movements, and what igrip predicted, and is
    sessions/PARTICIPANT/summary.html; igrip experiment run writes it at the end, too.

    Example: igrip experiment summary my-study --participant P01
    """
    place = StudyFolder(folder)
    with place.locked():
        _summarise(place, participant)


@experiment.command()
def status(folder: Folder, as_json: options.Json = False) -> None:
    """Show how far each participant is.

    Example: igrip experiment status my-study
    """
    place = StudyFolder(folder)
    found = []
    for name in place.participants():
        progress_of = place.progress(name)
        states = [one.state.value for one in progress_of.attempts]
        found.append({
            "participant": name, "done": len(progress_of.done), "of": place.study.trial_count,
            "repeated": states.count("repeated"), "wrong": states.count("wrong"),
            "interrupted": states.count("interrupted"),
        })  # fmt: skip
    if as_json:
        print_json(found)
        return
    if not found:
        output.print("nobody has taken part yet")
        return
    names = list(found[0])
    output.print(table_of(names, [[str(row[name]) for name in names] for row in found]))
