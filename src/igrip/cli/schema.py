"""``igrip schema``: the JSON schemas of the messages, generated from the code."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from igrip.cli.console import print_json
from igrip.intention import Intention
from igrip.observation import Observation


class SchemaName(StrEnum):
    """The messages that have a schema."""

    observation = "observation"
    intention = "intention"


def schema(message: Annotated[SchemaName, typer.Argument(help="Which message.")]) -> None:
    """Print the JSON schema of a message.

    Example: igrip schema observation > observation.json
    """
    kind = Observation if message is SchemaName.observation else Intention
    print_json(kind.json_schema())
