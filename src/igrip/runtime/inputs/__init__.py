"""Inputs of the loop, by name: where observations and commands come from."""

from __future__ import annotations

from collections.abc import Callable

from igrip.registry import Registry
from igrip.runtime.loop import Input
from igrip.runtime.options import Options

INPUTS: Registry[Callable[[Options], Input]] = Registry(
    "input", "igrip.runtime.inputs", "igrip.inputs"
)
