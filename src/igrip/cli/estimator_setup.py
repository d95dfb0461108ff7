"""What ``igrip live`` and ``igrip stream`` share: options, configuration and warm-up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

from igrip.commitment import ALL_HANDS, CommitmentConfig
from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

RELIABILITY = CommitmentConfig().reliability

Targets = Annotated[str | None, typer.Option(help="Targets estimator. Default: the library's.")]
Assisted = Annotated[
    list[str] | None,
    typer.Option(help="A hand that a device assists; repeatable. No other gets a commitment. "
                 "Default: every hand."),
]  # fmt: skip
Reliability = Annotated[
    float,
    typer.Option(help="0: commit early, sometimes wrongly; 1: late, or not at all.",
                 min=0.0, max=1.0),
]  # fmt: skip
Confirm = Annotated[
    bool, typer.Option("--confirm", help="Commit only to reaches that are confirmed from outside.")
]
Host = Annotated[str, typer.Option(help="Address of the WebSocket server.")]
Port = Annotated[int, typer.Option(help="Its port; 0: any that is free.", min=0, max=65535)]
Token = Annotated[
    str | None,
    typer.Option(envvar="IGRIP_TOKEN", help="Required of clients; needed where others can reach "
                 "the address."),
]  # fmt: skip


def estimator_config(
    targets: str | None, assisted: Sequence[str] | None, reliability: float, confirm: bool
) -> Config:
    """Return the configuration of an estimator that these options ask for."""
    commitment = CommitmentConfig(
        assisted=tuple(assisted) if assisted else ALL_HANDS, reliability=reliability,
        needs_confirmation=confirm,
    )  # fmt: skip
    return Config(commitment=commitment, targets=targets or Config().targets)


def warm_up(config: Config, catalog: Catalog) -> None:
    """Compile all that an estimator runs, on a scene of one hand and one object."""
    model = next(iter(catalog), None)
    if model is None:
        raise IgripError("there are no objects to look for (--objects)")
    pose = {"model": model, "position": [0.0, 0.4, 0.0], "orientation": [0.0, 0.0, 0.0, 1.0]}
    estimator = Estimator(catalog, config)
    for k in range(12):
        hands = {"right": {"position": [0.0, 0.02 * k, 0.0]}}
        estimator.update(Observation(t=k / 30.0, hands=hands, objects={"warm-up": pose}))
