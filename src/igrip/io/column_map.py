"""The map of the columns of tables of any layout: a TOML file."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from pydantic import ValidationError

from igrip.errors import DatasetError
from igrip.io.takes.declared import Declared
from igrip.io.text import TextError, read_text
from igrip.settings import Settings, problem_of

TRIALS = "trials"


class _Part(Settings):
    """A table of the map; an unknown entry is an error that names the one that was meant."""


class BodyColumns(_Part):
    """A body: by its name in the file, or by columns (``Mug/X`` where a header has several rows).

    Attributes
    ----------
    body : str or None
        Its name, as ``igrip import --inspect`` lists it.
    x, y, z : str or None
        Columns of its position, in place of ``body``.
    """

    body: str | None = None
    x: str | None = None
    y: str | None = None
    z: str | None = None

    @property
    def columns(self) -> tuple[str, str, str] | None:
        """The columns of its position, if they are named."""
        if self.x is None or self.y is None or self.z is None:
            return None
        return self.x, self.y, self.z


class SampleColumns(BodyColumns):
    """The tables of samples, and the hand of the trial in them; one row per sample.

    Attributes
    ----------
    table : str
        Pattern of the names of the tables.
    trial : str or None
        Column of the trial; without it each table is one trial, named as its file.
    t : str or None
        Column of the times; None: ``t``, or what the layout states, or frame number and rate.
    frame : str or None
        Column of frame numbers, which need ``rate``.
    """

    table: str = "*"
    trial: str | None = None
    t: str | None = None
    frame: str | None = None


class TrialColumns(_Part):
    """The table and columns of the trials, one row per trial; ``=text`` is the text itself.

    Without a table named ``trials``, each take is a trial.
    """

    table: str = TRIALS
    trial: str = "trial"
    participant: str = "participant"
    hand: str = "hand"
    target: str = "target"
    grip: str | None = None
    movement: str | None = None
    onset_s: str | None = None
    end_s: str | None = None


class ObjectColumns(_Part):
    """An object: where it lies, by columns of the table of trials or numbers; or its body.

    Attributes
    ----------
    x, y, z : str, float or None
        Of its place.
    body : str or None
        Name of the body that was tracked, in place of these.
    pivot : str
        What was tracked: ``middle``, the middle of the object, which stood upright where the body
        is not turned; or ``mesh``, the origin and axes of its mesh.
    model : str or None
        In the catalogue; by default that of the option ``--mesh``.
    """

    x: str | float | None = None
    y: str | float | None = None
    z: str | float | None = None
    body: str | None = None
    pivot: Literal["middle", "mesh"] = "middle"
    model: str | None = None


class ColumnMap(_Part):
    """The whole map.

    Attributes
    ----------
    name, license, source : str
        For ``dataset.json``.
    unit, time_unit : str or None
        Of lengths and times; None: what the file declares, else metres and seconds.
    rate : float or None
        Frames per second, for tables without times [Hz].
    up, axes, handedness, quaternions
        The frame of the file (:meth:`igrip.io.frames.DeclaredFrame.declare`).
    rotations : str or None
        What three numbers of a rotation are: ``rotvec``, or the axes of Euler angles, ``XYZ``.
    missing : list
        Further words and numbers that stand for a missing number.
    """

    name: str = "imported tables"
    license: str = "unknown"
    source: str = "unknown"
    unit: Literal["m", "dm", "cm", "mm", "in"] | None = None
    time_unit: Literal["s", "ms", "us", "ns"] | None = None
    rate: float | None = None
    up: str | None = None
    axes: tuple[str, str, str] | None = None
    handedness: Literal["right", "left"] | None = None
    quaternions: Literal["xyzw", "wxyz"] | None = None
    rotations: str | None = None
    missing: tuple[str | float, ...] | str | float = ()
    samples: SampleColumns = SampleColumns()
    trials: TrialColumns = TrialColumns()
    hands: Mapping[str, BodyColumns] = {}
    objects: Mapping[str, ObjectColumns] = {}

    @property
    def declared(self) -> Declared:
        """What the map declares of the files."""
        missing = self.missing if isinstance(self.missing, tuple) else (self.missing,)
        return Declared(
            up=self.up, axes=self.axes, handedness=self.handedness, quaternions=self.quaternions,
            length_unit=self.unit, time_unit=self.time_unit, rate=self.rate,
            rotations=self.rotations, missing=tuple(map(str, missing)),
        )  # fmt: skip


def read_column_map(path: Path) -> ColumnMap:
    """Read a map of columns.

    Raises
    ------
    DatasetError
        If it cannot be read, or an entry is unknown or wrong; the message names it.
    """
    try:
        columns = ColumnMap.model_validate(tomllib.loads(read_text(path)))
    except TextError as error:
        raise DatasetError(str(error)) from error
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise DatasetError(f"{path}: {error}") from error
    except ValidationError as error:
        raise DatasetError(f"{path}: {problem_of(error)}") from None
    for id, thing in columns.objects.items():
        given = [axis for axis in "xyz" if getattr(thing, axis) is not None]
        if (thing.body is None) == (not given) or (given and len(given) < 3):
            raise DatasetError(f"{path}: objects.{id}: needs either x, y and z or body")
    return columns
