"""``igrip stream``: the estimator as a service for other programs."""

from __future__ import annotations

import os
import sys
import threading
from enum import StrEnum
from typing import Annotated

import typer

from igrip.cli.console import errors
from igrip.commitment import ALL_HANDS, CommitmentConfig
from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.objects.catalog import Catalog, load_objects
from igrip.observation import Observation
from igrip.runtime.access import Access
from igrip.runtime.outputs.stdout import StdoutOutput
from igrip.runtime.service import Service, close
from igrip.runtime.stdin import read_lines

REPORT_EVERY = 1.0  # s between two looks at the counts for /status


class Way(StrEnum):
    """A way in."""

    STDIN = "stdin"
    WS = "ws"


class Out(StrEnum):
    """A way out."""

    STDOUT = "stdout"
    WS = "ws"
    LSL = "lsl"


def stream(
    into: Annotated[
        list[Way] | None, typer.Option("--in", help="Where observations come from; repeatable.")
    ] = None,
    out: Annotated[
        list[Out] | None, typer.Option("--out", help="Where intentions go; repeatable.")
    ] = None,
    objects: Annotated[
        list[str] | None, typer.Option(help="Where models come from. Default: ycb.")
    ] = None,
    preload: Annotated[
        list[str] | None,
        typer.Option(help="A model to read now rather than when it first appears, which takes up "
                     "to some seconds on a new machine; repeatable."),
    ] = None,
    targets: Annotated[str | None, typer.Option(help="Targets estimator.")] = None,
    assisted: Annotated[
        list[str] | None,
        typer.Option(help="A hand that a device assists; repeatable. No other gets a commitment. "
                     "Default: every hand."),
    ] = None,
    reliability: Annotated[
        float, typer.Option(help="0: commit early, sometimes wrongly; 1: late, or not at all.",
                            min=0.0, max=1.0),
    ] = CommitmentConfig().reliability,
    confirm: Annotated[
        bool, typer.Option("--confirm", help="Commit to what is confirmed from outside only.")
    ] = False,
    host: Annotated[str, typer.Option(help="Address of the WebSocket server.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Its port; 0: any.", min=0, max=65535)] = 8765,
    token: Annotated[
        str | None,
        typer.Option(envvar="IGRIP_TOKEN", help="What clients must show; needed where others can "
                     "reach the address."),
    ] = None,
    name: Annotated[str, typer.Option(help="Of the LSL streams.")] = "igrip",
    senders_clock: Annotated[
        bool | None,
        typer.Option("--senders-clock/--arrival-clock",
                     help="Whether times are the sender's (a recording that is piped in; default "
                     "with stdin alone) or of arrival."),
    ] = None,
) -> None:  # fmt: skip
    """Take observations from other programs and tell them intentions, until Ctrl-C.

    WebSocket: observations to ws://HOST:PORT/observations, intentions from /intentions (JSON, or
    MessagePack with ?format=msgpack), counts at http://HOST:PORT/status. Messages: docs/stream.md.

    Example: igrip stream --in stdin --out stdout < reach.jsonl
    """
    ways, outs = into or [Way.WS], out or [Out.WS]
    lone = ways == [Way.STDIN]
    if senders_clock and not lone:
        raise IgripError("--senders-clock is for --in stdin alone: of several, one would rule time")
    commitment = CommitmentConfig(
        assisted=tuple(assisted) if assisted else ALL_HANDS, reliability=reliability,
        needs_confirmation=confirm,
    )  # fmt: skip
    config = Config(commitment=commitment, targets=targets or Config().targets)
    served = Way.WS in ways or Out.WS in outs
    access = Access(host, token) if served else None
    with errors.status("Reading meshes, compiling the geometry (some seconds the first time) …"):
        catalog = load_objects(*(objects or ["ycb"]))
        for model in preload or []:
            catalog[model]
        warm_up(config, catalog)
    estimator = Estimator(catalog, config)
    errors.print(f"commits for: {', '.join(assisted) if assisted else 'every hand'}")
    service = Service(estimator, lone if senders_clock is None else senders_clock)
    try:
        if access is not None:
            _serve(service, host, port, access, Way.WS in ways, Out.WS in outs)
        if Out.STDOUT in outs:
            service.outputs.append(StdoutOutput(patient=lone))
        if Out.LSL in outs:
            from igrip.runtime.outputs.lsl import HANDS, LslOutput

            hands = tuple(assisted) if assisted else HANDS
            service.outputs.append(LslOutput(name, service.numbering.session, hands))
        if Way.STDIN in ways:
            threading.Thread(
                target=read_lines, args=(sys.stdin.buffer, service, lone, lone), daemon=True
            ).start()
        service.run(REPORT_EVERY)
    except KeyboardInterrupt:
        errors.print("stopped")
    except BrokenPipeError:
        errors.print("nobody reads standard output any more")
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    finally:
        close(service.outputs)
        errors.print(_words(service), soft_wrap=True)


def _serve(
    service: Service, host: str, port: int, access: Access, takes: bool, tells: bool
) -> None:
    from igrip.runtime.websocket import WebSocketServer

    server = WebSocketServer(
        host, port, access, service.take, service.inbox.count, service.status, takes, tells
    )
    service.outputs.append(server)
    service.answer = server.answer
    address = f"[{host}]" if ":" in host else host
    errors.print(f"ws://{address}:{server.port}", soft_wrap=True)


def warm_up(config: Config, catalog: Catalog) -> None:
    """Compile before the first message comes, on a scene of no importance."""
    model = next(iter(catalog), None)
    if model is None:
        raise IgripError("there are no objects to look for (--objects)")
    pose = {"model": model, "position": [0.0, 0.4, 0.0], "orientation": [0.0, 0.0, 0.0, 1.0]}
    estimator = Estimator(catalog, config)
    for k in range(12):
        hands = {"right": {"position": [0.0, 0.02 * k, 0.0]}}
        estimator.update(Observation(t=k / 30.0, hands=hands, objects={"warm-up": pose}))


def _words(service: Service) -> str:
    """Sum up what happened, in a line."""
    status = service.status()
    incoming = ", ".join(f"{n} {what}" for what, n in status.get("incoming", {}).items())
    outputs = "; ".join(
        f"{kind}: {', '.join(f'{n} {what}' for what, n in counts.items())}"
        for kind, counts in status.get("outputs", {}).items()
    )
    return f"{status.get('intentions', 0)} intentions. In: {incoming}. Out: {outputs or 'nothing'}."
