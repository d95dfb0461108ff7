"""Exporters of datasets to other formats, one module for each, found by name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from igrip.io.datasets.dataset import Dataset
from igrip.registry import Registry

__all__ = ["EXPORTERS", "Exporter"]


class Exporter(Protocol):
    """Writes a dataset in one format."""

    def __call__(
        self, dataset: Dataset, folder: Path, on_recording: Callable[[], object]
    ) -> list[str]:
        """Write all recordings and tables.

        Parameters
        ----------
        dataset : Dataset
            What is exported.
        folder : Path
            Exists and is empty.
        on_recording : function
            Called after each recording.

        Returns
        -------
        list of str
            What could not be exported, a line for each recording that is left out.
        """
        ...


EXPORTERS: Registry[Exporter] = Registry("exporter", "igrip.io.exporters", "igrip.exporters")
