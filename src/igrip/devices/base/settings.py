"""Configuration of a device: a readable TOML file, checked as a whole before anything is opened."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import Field, ValidationError, field_validator, model_validator

from igrip.devices.base.limits import MAX_CURRENT, MAX_FREQUENCY, MAX_WIDTH
from igrip.errors import IgripError
from igrip.io.text import TextError, read_text
from igrip.settings import Settings, problem_of, quantity
from igrip.taxonomy import GRIP_TYPES, PAPER_GRIP, stand_in

Phase = Literal["reach", "grasp"]
TWIN = "twin"


class DeviceFileError(IgripError, ValueError):
    """A file is no configuration of this device; the message names the file and the key."""


class DeviceSettings(Settings):
    """What all devices have in common.

    Attributes
    ----------
    port : str
        Serial port; ``twin``: the virtual device.
    hand : str
        The hand it assists.
    when_silent : str
        What the end of the lease means once it holds: ``stop``, or ``keep`` what it holds, without
        closing further. Before it holds, the end always stops it.
    instead : dict
        For a grip that it cannot do, those to do instead, the first that it can. Without an entry
        the taxonomy's nearest is done (:data:`igrip.taxonomy.GRIP_TYPES`), but nothing for the
        paper's two grips: a device that has no pinch refuses to pinch.
    """

    port: str = TWIN
    hand: str = "right"
    when_silent: Literal["stop", "keep"] = "stop"
    close_before: float = quantity(
        0.3, "s", "it begins to close this long before the predicted contact, and at the latest "
        "when the hand holds", "guess", ge=0, le=2,
    )  # fmt: skip
    confirm: bool = False
    instead: dict[str, tuple[str, ...]] = Field(default_factory=dict)

    @field_validator("instead")
    @classmethod
    def _check_instead(cls, instead: dict[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
        unknown = [grip for grip in instead if grip not in GRIP_TYPES]
        if unknown:
            raise ValueError(f"no grip {unknown[0]!r:.40}; there are: {', '.join(GRIP_TYPES)}")
        return instead

    def grip_names(self) -> tuple[str, ...]:
        """Return the grips it can do."""
        return ()

    def grip_for(self, grip: str) -> str | None:
        """Return the grip that it does when this one is asked for; None: it refuses."""
        able = self.grip_names()
        order = self.instead.get(grip)
        if order is not None:
            return next((name for name in (grip, *order) if name in able), None)
        if grip in PAPER_GRIP.values():
            return grip if grip in able else None
        return stand_in(grip, able)


class Channel(Settings):
    """One channel of a stimulator in a pattern."""

    number: int = quantity(1, "1", "of the channel", ge=1, le=8)
    current_ma: float = quantity(0.0, "mA", "of the pulses, after the ramp", ge=0, le=MAX_CURRENT)
    width_us: int = quantity(200, "µs", "of each phase of a pulse", ge=20, le=MAX_WIDTH)
    muscle: str = ""


class Pattern(Settings):
    """What a stimulator does for one grip, by phase; no channels in ``reach``: nothing."""

    reach: tuple[Channel, ...] = ()
    grasp: tuple[Channel, ...]


class StimulatorSettings(DeviceSettings):
    """Functional electrical stimulation: patterns of channels.

    Raises
    ------
    ValidationError
        Among others if a channel's current is above ``limit_ma``, or that above the limit in code.
    """

    limit_ma: float = quantity(
        10.0, "mA", "no channel may have more", "guess", gt=0, le=MAX_CURRENT
    )
    ramp: float = quantity(
        0.3, "s", "a current takes this long from 0 to the limit", "guess", ge=0.05, le=5
    )
    frequency: float = quantity(40.0, "Hz", "of the pulses", "guess", ge=1, le=MAX_FREQUENCY)
    grips: dict[str, Pattern]

    @model_validator(mode="after")
    def _check_channels(self) -> StimulatorSettings:
        if self.when_silent == "keep":
            raise ValueError("when_silent: a stimulator cannot keep; silence stops it")
        for grip, pattern in self.grips.items():
            for phase, channels in (("reach", pattern.reach), ("grasp", pattern.grasp)):
                numbers = [channel.number for channel in channels]
                if len(set(numbers)) < len(numbers):
                    raise ValueError(f"grips.{grip}.{phase}: a channel stands there twice")
                for channel in channels:
                    if channel.current_ma > self.limit_ma:
                        raise ValueError(
                            f"grips.{grip}.{phase}: {channel.current_ma:g} mA on channel "
                            f"{channel.number} is above limit_ma ({self.limit_ma:g})"
                        )
        return self

    def grip_names(self) -> tuple[str, ...]:
        """Return the grips that have a pattern."""
        return tuple(self.grips)

    def numbers(self) -> tuple[int, ...]:
        """Return all channels that any pattern uses, sorted."""
        return tuple(sorted({
            channel.number for pattern in self.grips.values()
            for channel in (*pattern.reach, *pattern.grasp)
        }))  # fmt: skip


class Posture(Settings):
    """Positions of the joints for one grip.

    Attributes
    ----------
    reach, grasp : tuple of float
        On the way, and closed on something of no width.
    grasp_wide : tuple of float, optional
        Closed on an object of ``max_aperture``; between the two by the object's width.
    """

    reach: tuple[float, ...]
    grasp: tuple[float, ...]
    grasp_wide: tuple[float, ...] | None = None


class PostureSettings(DeviceSettings):
    """A hand with joints: a posture for each grip and aperture.

    Attributes
    ----------
    apertures : dict
        Width of each model where it is grasped [m].
    """

    when_silent: Literal["stop", "keep"] = "keep"
    rest: tuple[float, ...]
    grips: dict[str, Posture]
    apertures: dict[str, float] = Field(default_factory=dict)
    max_aperture: float = quantity(0.1, "m", "width that grasp_wide is meant for", "guess", gt=0)

    @model_validator(mode="after")
    def _check_postures(self) -> PostureSettings:
        for grip, posture in self.grips.items():
            for name in ("reach", "grasp", "grasp_wide"):
                joints = getattr(posture, name)
                if joints is not None and len(joints) != len(self.rest):
                    raise ValueError(f"grips.{grip}.{name}: needs {len(self.rest)} numbers")
        return self

    def grip_names(self) -> tuple[str, ...]:
        """Return the grips that have a posture."""
        return tuple(self.grips)

    def goal(self, grip: str, phase: Phase, model: str | None) -> tuple[float, ...]:
        """Return the positions of the joints for a grip; KeyError if there is none."""
        posture = self.grips[grip]
        if phase == "reach":
            return posture.reach
        if posture.grasp_wide is None:
            return posture.grasp
        share = min(1.0, max(0.0, self.apertures.get(model or "", 0.0) / self.max_aperture))
        return tuple(
            a + share * (b - a) for a, b in zip(posture.grasp, posture.grasp_wide, strict=True)
        )


S = TypeVar("S", bound=DeviceSettings)


def read_settings(kind: type[S], path: Path, **changes: Any) -> S:
    """Read the configuration of a device.

    Raises
    ------
    DeviceFileError
        If it cannot be read, a key is unknown, or a value is out of bounds.
    """
    try:
        return kind(**{**tomllib.loads(read_text(path)), **changes})
    except OSError as error:
        raise DeviceFileError(f"{path}: {error.strerror or error}") from error
    except (TextError, tomllib.TOMLDecodeError) as error:
        raise DeviceFileError(f"{path}: is not TOML: {error}") from error
    except ValidationError as error:
        raise DeviceFileError(f"{path}: {problem_of(error)}") from error
