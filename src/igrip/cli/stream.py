"""``igrip stream``: the estimator as a service for other programs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from igrip.cli import estimator_setup as setup
from igrip.cli import options
from igrip.cli.console import errors, until_interrupted, warn
from igrip.cli.outputs import free_port
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.io.frames import DeclaredFrame
from igrip.io.hand_ids import match_hand
from igrip.io.person_file import PersonFile
from igrip.objects.catalog import load_objects
from igrip.runtime.clock_sync import ArrivalClock, SenderClock
from igrip.runtime.inputs import INPUTS
from igrip.runtime.loop import Loop
from igrip.runtime.options import HANDS, Options
from igrip.runtime.outputs import OUTPUTS


def stream(
    inputs: Annotated[
        list[str] | None,
        typer.Option("--in", help="Where observations come from: ws (default), stdin, lsl, osc "
                     "or ros2; repeatable."),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        typer.Option("--out", help="Where intentions go: ws (default), stdout, lsl, udp, osc, "
                     "mqtt or ros2; repeatable."),
    ] = None,
    objects: options.Objects = None,
    preload: Annotated[
        list[str] | None,
        typer.Option(help="A model to read now rather than when it first appears, which can take "
                     "seconds on a new machine; repeatable."),
    ] = None,
    config: options.ConfigFile = None,
    targets: options.Targets = None,
    assisted: options.Assisted = None,
    reliability: options.Reliability = None,
    confirm: options.Confirm = False,
    person: options.Person = None,
    host: options.Host = "127.0.0.1",
    port: options.Port = 8765,
    token: options.Token = None,
    name: Annotated[str, typer.Option(help="Of the LSL streams.")] = "igrip",
    lsl_source: Annotated[
        str | None,
        typer.Option(help="Name of the LSL stream to read. Default: each of type MoCap."),
    ] = None,
    osc_port: Annotated[int, typer.Option(help="UDP port of --in osc.", min=0, max=65535)] = 9000,
    udp_to: options.UdpTo = Options.udp_to,
    osc_to: options.OscTo = Options.osc_to,
    mqtt: options.Mqtt = Options.mqtt,
    ros_frame: options.RosFrame = Options.ros_frame,
    senders_clock: Annotated[
        bool | None,
        typer.Option("--senders-clock/--arrival-clock",
                     help="Whether time is that of the sender (a recording that is piped in; the "
                     "default with stdin alone) or that of arrival."),
    ] = None,
    up: options.Up = None,
    axes: options.Axes = None,
    handedness: options.Handedness = None,
    quaternions: options.Quaternions = "xyzw",
    length_unit: options.LengthUnit = "m",
    time_unit: options.TimeUnit = "s",
) -> None:  # fmt: skip
    """Receive observations from other programs and send them intentions, until Ctrl-C.

    WebSocket: observations to ws://HOST:PORT/observations, intentions from /intentions (JSON, or
    MessagePack with ?format=msgpack), counts at http://HOST:PORT/status. Messages: docs/stream.md.

    Data of another frame or other units are converted: --up y --length-unit mm.

    Example: igrip stream --in stdin --out stdout < reach.jsonl
    """
    frame = DeclaredFrame.declare(up, axes, handedness, quaternions, length_unit, time_unit)
    shared = Options(host, port, token, name, lsl_source, osc_port, tuple(assisted or HANDS), frame,
                     udp_to, osc_to, mqtt, ros_frame)  # fmt: skip
    members = {key: INPUTS.get(key)(shared) for key in inputs or ["ws"]}
    outlets = {key: OUTPUTS.get(key)(shared) for key in outputs or ["ws"]}
    piped = len(members) == 1 and all(member.single_sender for member in members.values())
    if senders_clock and not piped:
        raise IgripError(
            "--senders-clock is for --in stdin alone: with several senders, one clock would rule"
        )
    if "ws" in {*members, *outlets}:
        free_port(port, host=host)
    if "osc" in members:
        free_port(osc_port, "--osc-port", host, udp=True)
    settings = setup.estimator_config(targets, assisted, reliability, confirm, config)
    kept = None if person is None else PersonFile(person, settings.commitment.adaptation)
    with errors.status("Reading meshes, compiling the geometry (some seconds the first time) …"):
        catalog = load_objects(*(objects or ["ycb"]))
        for model in preload or []:
            catalog[model]
        setup.warm_up(settings, catalog)
    errors.print(f"commits for: {', '.join(assisted) if assisted else 'every hand'}")
    by_sender = piped if senders_clock is None else senders_clock
    loop = Loop(
        Estimator(catalog, settings, None if kept is None else kept.person),
        SenderClock() if by_sender else ArrivalClock(), members, outlets, piped,
        announce=lambda address: errors.print(address, soft_wrap=True), warn=warn,
    )  # fmt: skip

    def after_update(intentions: list[Intention]) -> None:
        if kept is not None:
            kept.keep()
        for hand in {intention.hand for intention in intentions} - set(assisted or ()):
            if assisted and match_hand(hand, assisted) is not None:
                loop.warn(f"hand {hand!r:.60} gets no commitment: --assisted {hand:.60}")
        if loop.abandoned:
            raise BrokenPipeError

    try:
        with until_interrupted(), loop:
            loop.run(after_update)
    except BrokenPipeError:
        errors.print("nobody reads standard output any more")
    finally:
        if kept is not None:
            kept.keep()
        for line in loop.senders.lines():
            warn(line)
        errors.print(_summary(loop.status()), soft_wrap=True)


def _summary(status: Mapping[str, Any]) -> str:
    """Return the counts as one line."""
    outputs = "; ".join(f"{name}: {_counts(counts)}" for name, counts in status["outputs"].items())
    return f"{status['intentions']} intentions. In: {_counts(status['incoming'])}. Out: {outputs}."


def _counts(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{number} {event}" for event, number in counts.items())
