"""Outputs of the loop, by name: where intentions go."""

from __future__ import annotations

from collections.abc import Callable

from igrip.registry import Registry
from igrip.runtime.loop import Output
from igrip.runtime.options import Options

OUTPUTS: Registry[Callable[[Options], Output]] = Registry(
    "output", "igrip.runtime.outputs", "igrip.outputs"
)
