"""A study: factors and levels, objects, places, cameras and breaks, in a readable TOML file."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from importlib import resources
from itertools import product
from pathlib import Path

from pydantic import Field, ValidationError, model_validator

from igrip.errors import IgripError, UnknownNameError, did_you_mean
from igrip.io.text import TextError, read_text
from igrip.settings import Settings, problem_of, quantity
from igrip.targets import TARGETS

FILE = "study.toml"
NEEDED = ("hand", "target")
HANDS = ("left", "right")
KNOWN = (*NEEDED, "grip", "movement")  # factors that are columns of trials.tsv
TEMPLATES = ("paper", "small")
MAX_TRIALS = 10_000  # of a participant


class StudyError(IgripError, ValueError):
    """A study cannot be run as it is written; the message names the file and the key."""


class StudyObject(Settings):
    """An object that stands on the table.

    Attributes
    ----------
    model : str
        Of the catalog.
    colour : str
        Of its picture on the participant's screen, ``#rrggbb``.
    names : mapping of str to str
        What the participant reads, by language.
    """

    model: str
    colour: str = Field("#7f7f7f", pattern="^#[0-9a-fA-F]{6}$")
    names: dict[str, str] = Field(default_factory=dict)


class Layouts(Settings):
    """Where objects may stand; they change places at random.

    Attributes
    ----------
    places : mapping of str to (x, y)
        Names of places on the table, with their coordinates [m].
    """

    places: dict[str, tuple[float, float]]
    change_every: int = quantity(32, "trials", "the objects stay where they are", ge=1)


class Breaks(Settings):
    """When the participant rests."""

    every: int = quantity(32, "trials", "between two breaks", ge=1)
    seconds: float = quantity(60.0, "s", "a break lasts, at least", ge=0, le=3600)


class Study(Settings):
    """What a lab wants to measure.

    Attributes
    ----------
    name, license : str
        Of the dataset.
    language : str
        Of the participant's screen: ``en``, ``fr``, or that of a file ``instructions/….toml`` in
        the study's folder.
    factors : mapping of str to list of str
        Levels of each factor; every combination is done ``repetitions`` times, in random order.
        ``hand`` and ``target`` must be there; ``grip`` and ``movement`` are known, too.
    max_in_a_row : mapping of str to int
        So many successive trials may have the same level of a factor.
    objects : mapping of str to StudyObject
        What stands on the table, by the id that it has in recordings.
    models : list of str
        Sources of the catalog: ``ycb``, folders of meshes in the study's folder.
    layouts, breaks : Layouts, Breaks
        Places of the objects; rests.
    cameras : list of str
        Names; each records every trial.
    predictions : str or None
        Targets estimator whose intentions are recorded beside the observations; None: none are.
    """

    name: str
    license: str = "not decided"
    language: str = Field("en", pattern="^[a-z]{2,3}$")
    seed: int = quantity(0, "1", "of the random order, together with the participant", ge=0)
    repetitions: int = quantity(1, "1", "of each combination of levels", ge=1, le=1000)
    rate: float = quantity(30.0, "Hz", "of the cameras", "paper", gt=0, le=240)
    max_seconds: float = quantity(10.0, "s", "a trial stops by itself after it", gt=0, le=600)
    cameras: tuple[str, ...] = Field(("left", "right"), min_length=1)
    models: tuple[str, ...] = ("ycb",)
    predictions: str | None = None
    factors: dict[str, tuple[str, ...]]
    max_in_a_row: dict[str, int] = Field(default_factory=dict)
    objects: dict[str, StudyObject]
    layouts: Layouts
    breaks: Breaks = Breaks()

    @model_validator(mode="after")
    def _check(self) -> Study:
        for factor, levels in self.factors.items():
            near = did_you_mean(factor, KNOWN)
            if factor not in KNOWN and near:
                raise ValueError(f"factors.{factor}: no such factor is known{near}")
            if not levels or len(set(levels)) < len(levels) or not all(levels):
                raise ValueError(f"factors.{factor}: needs levels, each once")
        for factor in NEEDED:
            if factor not in self.factors:
                there = ", ".join(self.factors)
                raise ValueError(f"factors: {factor} is missing; there are: {there}")
        _refuse_unknown("factors.target", self.factors["target"], self.objects)
        _refuse_unknown("factors.hand", self.factors["hand"], HANDS)
        _refuse_unknown("max_in_a_row", self.max_in_a_row, self.factors)
        for factor, most in self.max_in_a_row.items():
            if most < 1 or (most < len(self.combinations()) and len(self.factors[factor]) == 1):
                raise ValueError(f"max_in_a_row.{factor}: {most} cannot be kept")
        for name in (*self.cameras, *self.objects):
            if not name or not all(c.isalnum() or c in "-_" for c in name):
                raise ValueError(f"{name!r:.40}: names have letters, digits, - and _ only")
        for name in HANDS:
            if name in self.objects:
                raise ValueError(f"objects.{name}: this is the name of a hand; choose another")
        if len(self.layouts.places) < len(self.objects):
            raise ValueError(
                f"layouts.places: {len(self.layouts.places)} places for {len(self.objects)} objects"
            )
        if self.predictions is not None:
            TARGETS.check(self.predictions)
        if self.trial_count > MAX_TRIALS:
            raise ValueError(f"repetitions: {self.trial_count} trials; {MAX_TRIALS} at most")
        return self

    def combinations(self) -> list[dict[str, str]]:
        """Return every combination of levels."""
        every = product(*self.factors.values())
        return [dict(zip(self.factors, levels, strict=True)) for levels in every]

    @property
    def trial_count(self) -> int:
        """How many trials a participant has."""
        count = self.repetitions
        for levels in self.factors.values():
            count *= len(levels)
        return count


def _refuse_unknown(key: str, names: Collection[str], known: Collection[str]) -> None:
    for name in names:
        if name not in known:
            near, there = did_you_mean(name, known), ", ".join(known)
            raise ValueError(f"{key}: there is no {name!r:.40}{near}; there are: {there}")


def read_study(folder: Path) -> Study:
    """Read the study of a folder.

    Raises
    ------
    StudyError
        If there is none, or it cannot be run; the message names the key and the way out.
    """
    path = folder / FILE
    try:
        return Study(**tomllib.loads(read_text(path)))
    except FileNotFoundError:
        raise StudyError(
            f"{folder}: holds no {FILE}; igrip experiment new {folder} writes one"
        ) from None
    except OSError as error:
        raise StudyError(f"{path}: {error.strerror or error}") from error
    except TextError as error:
        raise StudyError(str(error)) from error
    except tomllib.TOMLDecodeError as error:
        raise StudyError(f"{path}: is not TOML: {error}") from error
    except ValidationError as error:
        raise StudyError(f"{path}: {problem_of(error)}") from error


def template_text(name: str) -> str:
    """Return the text of a study to begin with.

    Raises
    ------
    UnknownNameError
        If there is no such template.
    """
    if name not in TEMPLATES:
        raise UnknownNameError("template", name, TEMPLATES)
    return resources.files(__package__).joinpath(f"templates/{name}.toml").read_text("utf-8")


class Instructions(Settings):
    """Words of the participant's screen in one language.

    Attributes
    ----------
    screen : mapping of str to str
        ``wait`` (igrip does not run), ``ready``, ``go``, ``stop``, ``rest``, ``finished``.
    levels : mapping of str to mapping of str to str
        What stands for each level, by factor; a level without words stands for itself.
    """

    screen: dict[str, str]
    levels: dict[str, dict[str, str]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _check(self) -> Instructions:
        missing = [key for key in SCREEN if key not in self.screen]
        if missing:
            raise ValueError(f"screen: without {', '.join(missing)}")
        return self

    def words(self, levels: Mapping[str, str], study: Study) -> dict[str, str]:
        """Return what the participant reads of a trial, by factor."""
        names = {id: one.names.get(study.language, id) for id, one in study.objects.items()}
        known = {**self.levels, "target": names}
        return {factor: known.get(factor, {}).get(level, level) for factor, level in levels.items()}


SCREEN = ("wait", "ready", "go", "stop", "rest", "finished")


def read_instructions(folder: Path, language: str) -> Instructions:
    """Return the words of a language: from the study's own file, or one of igrip's.

    Raises
    ------
    StudyError
        If there is no such file, or something is missing in it.
    """
    own = folder / "instructions" / f"{language}.toml"
    packaged = resources.files(__package__).joinpath(f"instructions/{language}.toml")
    try:
        text = read_text(own) if own.is_file() else packaged.read_text("utf-8")
        return Instructions(**tomllib.loads(text))
    except FileNotFoundError:
        raise StudyError(
            f"language: there are no words in {language!r}; write {own}, as instructions/en.toml "
            "of igrip, or choose en or fr"
        ) from None
    except (TextError, tomllib.TOMLDecodeError) as error:
        raise StudyError(f"{own}: {error}") from error
    except ValidationError as error:
        raise StudyError(f"{own}: {problem_of(error)}") from error
