"""Measurements of one hand or one object in one message."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import msgspec

from igrip.errors import ObservationError

QUATERNION_TOLERANCE = 5e-3

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Hand(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One measurement of one hand.

    Parameters
    ----------
    position : 3 floats
        Palm centre in the world frame [m].
    t : float, optional
        Time of measurement on the clock of the message [s]; the message's own by default.
    orientation : 4 floats, optional
        World-from-hand rotation, unit quaternion x, y, z, w.
    landmarks : sequence of 3 floats, optional
        Points of the hand in the world frame [m], in the order of the detector.
    std : float or 3 floats, optional
        Standard deviation of the position, overall or per world axis [m].
    score : float, optional
        The detector's own confidence.
    source : str, optional
        Which sensor or detector measured it.

    Raises
    ------
    ObservationError
        If a value is not finite or not of the stated form.
    """

    position: Vector
    t: float | None = None
    orientation: Quaternion | None = None
    landmarks: tuple[Vector, ...] | None = None
    std: float | Vector | None = None
    score: float | None = None
    source: str | None = None

    def __post_init__(self) -> None:
        _check_entity(self)
        if self.landmarks is not None:
            points = items(self.landmarks, "landmarks")
            checked = (floats(point, 3, f"landmarks[{k}]") for k, point in enumerate(points))
            msgspec.structs.force_setattr(self, "landmarks", tuple(checked))


class ObjectPose(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One measurement of the pose of one object.

    The pose is that of the mesh as its model file defines it (world from mesh).

    Parameters
    ----------
    position : 3 floats
        Origin of the mesh in the world frame [m].
    orientation : 4 floats
        World-from-mesh rotation, unit quaternion x, y, z, w.
    model : str, optional
        Name in the catalogue; needed when an id first appears.
    t, std, score, source
        As for :class:`Hand`.
    static : bool
        True exempts the object from the age limit.

    Raises
    ------
    ObservationError
        If a value is not finite, not of the stated form, or the rotation is not a rotation.
    """

    position: Vector
    orientation: Quaternion
    model: str | None = None
    t: float | None = None
    static: bool = False
    std: float | Vector | None = None
    score: float | None = None
    source: str | None = None

    def __post_init__(self) -> None:
        if self.orientation is None:
            raise ObservationError("orientation", "is missing")
        _check_entity(self)
        if not isinstance(self.static, bool):
            raise ObservationError("static", "must be true or false")
        if self.model is not None:
            text(self.model, "model")


_FLOATS = {float}


def _check_entity(entity: Any) -> None:
    put = msgspec.structs.force_setattr
    put(entity, "position", floats(entity.position, 3, "position"))
    if entity.orientation is not None:
        quaternion = floats(entity.orientation, 4, "orientation")
        norm = math.hypot(*quaternion)
        if abs(norm - 1.0) > QUATERNION_TOLERANCE:
            raise ObservationError("orientation", f"is not a rotation: its norm is {norm:.6g}")
        put(entity, "orientation", quaternion)
    if entity.t is not None:
        put(entity, "t", time_of(entity.t, "t"))
    if entity.std is not None:
        std = entity.std.tolist() if hasattr(entity.std, "tolist") else entity.std
        std = floats(std, 3, "std") if isinstance(std, list | tuple) else number(std, "std")
        if (min(std) if isinstance(std, tuple) else std) < 0.0:
            raise ObservationError("std", "must not be negative")
        put(entity, "std", std)
    if entity.score is not None:
        put(entity, "score", number(entity.score, "score"))
    if entity.source is not None:
        text(entity.source, "source")


def items(values: Any, path: str) -> Sequence[Any]:
    """Return the items of a list, tuple or array, or raise naming ``path``."""
    values = values.tolist() if hasattr(values, "tolist") else values
    if not isinstance(values, list | tuple):
        raise ObservationError(path, f"must be a list, got {kind_of(values)}")
    return values


def floats(values: Any, length: int, path: str) -> tuple[Any, ...]:
    """Return ``length`` finite numbers, or raise naming ``path`` and the index."""
    if type(values) is list and len(values) == length and set(map(type, values)) == _FLOATS:
        found = tuple(values)  # what JSON gives, without a call for each number
        if all(map(math.isfinite, found)):
            return found
    values = items(values, path)
    if len(values) != length:
        raise ObservationError(path, f"must be {length} numbers, got {len(values)}")
    return tuple(number(value, f"{path}[{index}]") for index, value in enumerate(values))


def number(value: Any, path: str) -> float:
    """Return a finite float, or raise naming ``path``."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ObservationError(path, f"must be a number, got {kind_of(value)}")
    try:
        result = float(value)
    except OverflowError:
        raise ObservationError(path, "is out of range") from None
    if not math.isfinite(result):
        raise ObservationError(path, f"must be finite, got {result}")
    return result


def time_of(value: Any, path: str) -> float:
    """Return a time that is not negative [s], or raise naming ``path``."""
    result = number(value, path)
    if result < 0.0:
        raise ObservationError(path, f"must not be negative, got {result:.6g}")
    return result


def text(value: Any, path: str) -> str:
    """Return a string that can be written as UTF-8, or raise naming ``path``."""
    if not isinstance(value, str):
        raise ObservationError(path, f"must be a string, got {kind_of(value)}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ObservationError(path, f"{value!a:.80} is no text") from None
    return value


def kind_of(value: Any) -> str:
    """Return the name of a value's type, as JSON or Python call it."""
    return "null" if value is None else type(value).__name__
