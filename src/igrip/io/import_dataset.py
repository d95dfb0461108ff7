"""Imported reaches written as a dataset."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from igrip.errors import DatasetError, IgripError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.io.importers import Importer, ReachReader, RecordedReach
from igrip.io.resampling import ImportOptions, observations_of
from igrip.objects.catalog import Catalog


def import_dataset(
    importer: Importer,
    reaches: Sequence[ReachReader],
    out: Path,
    catalog: Catalog,
    options: ImportOptions,
    objects: Sequence[str],
    problems: list[str] | None = None,
    on_progress: Callable[[], object] = lambda: None,
) -> Dataset:
    """Write reaches as a dataset.

    Parameters
    ----------
    importer : Importer
        Gives the dataset its name, licence and source.
    reaches : sequence of functions
        All or some of those that the importer returned.
    out, objects : Path, sequence of str
        A new folder, and the sources of the catalog for its ``dataset.json``.
    problems : list of str, optional
        Where given, a reach that cannot be used is left out, and the reason added here.
    on_progress : function
        Called after each reach.

    Raises
    ------
    DatasetError
        If the folder exists, a reach cannot be used and there is no list of problems, or nothing
        is left to write.
    """
    derived: dict[str, Any] = {
        "mesh": f"{options.mesh} where an object names no model and has no model's name; without "
        "a tracked pose, upright, the middle of the mesh's cylinder at the object's place",
        "resampled_to_hz": options.rate,
        "rest_before_onset_s": options.rest,
        "added_noise_sd_m": options.noise,
        "seed": options.seed,
    }
    writer = DatasetWriter(
        out,
        name=importer.name,
        license=importer.license,
        source=importer.source,
        objects=list(objects),
        derived=derived,
    )
    onset = round(options.rest * options.rate) / options.rate  # rest is a whole number of samples
    written = 0
    with writer:
        for read in reaches:
            try:
                reach = read()
                writer.add(_trial(reach, onset), observations_of(reach, catalog, options))
            except IgripError as error:
                if problems is None:
                    raise
                problems.append(str(error))
            else:
                _note(derived, reach)
                written += 1
            on_progress()
        if not written:
            raise DatasetError(_nothing(problems or []))
        return writer.close()


def _nothing(problems: Sequence[str]) -> str:
    more = f" (and {len(problems) - 3} more)" if len(problems) > 3 else ""
    reasons = "; ".join(problems[:3]) or "there is no trial"
    return f"nothing could be imported: {reasons}{more}"


def _note(derived: dict[str, Any], reach: RecordedReach) -> None:
    """Declare what was converted and repaired."""
    if reach.converted_from is not None:
        frames = derived.setdefault("converted_from", [])
        if reach.converted_from not in frames:
            frames.append(reach.converted_from)
    if reach.remarks:
        derived.setdefault("remarks", {})[reach.name] = list(reach.remarks)


def _trial(reach: RecordedReach, onset: float) -> Trial:
    if reach.movement_only:
        begin: float | None = round(onset, 6)
        end: float | None = round(onset + float(reach.times[-1]), 6)
    else:
        begin, end = reach.onset_s, reach.end_s
    return Trial(
        recording=reach.name,
        participant=reach.participant,
        trial=reach.trial,
        hand=reach.hand,
        target=reach.target,
        grip=reach.grip,
        movement=reach.movement,
        onset_s=begin,
        end_s=end,
        extra=reach.extra,
    )
