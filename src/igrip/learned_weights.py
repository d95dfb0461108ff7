"""Files of learned numbers: JSON with a format, a provenance and arrays that are checked."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import IgripError

Array = NDArray[np.float64]


def read_learned(path: Path, form: str) -> dict[str, Any]:
    """Read a file of learned numbers.

    Raises
    ------
    IgripError
        If it cannot be read, or is not of the format ``form``.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise IgripError(f"{path}: cannot be read as learned numbers: {error}") from error
    if not isinstance(content, dict) or content.get("format") != form:
        raise IgripError(f"{path}: is not of the format {form}; retrain it (make train)")
    return content


def numbers(content: Any, keys: Sequence[str], shape: tuple[int, ...], path: Path) -> Array:
    """Return the array under nested keys of a file's content; -1 in ``shape``: any length.

    Raises
    ------
    IgripError
        If there is none, or it has another shape or numbers that are not finite: compiled code
        reads these arrays without checking bounds.
    """
    try:
        for key in keys:
            content = content[key]
        values = np.array(content, dtype=np.float64)
    except (KeyError, TypeError, ValueError) as error:
        raise IgripError(f"{path}: has no numbers {'.'.join(keys)}") from error
    fits = len(values.shape) == len(shape) and all(
        expected in (-1, length) for expected, length in zip(shape, values.shape, strict=True)
    )
    if not fits or not np.isfinite(values).all():
        raise IgripError(f"{path}: {'.'.join(keys)} is not finite, or not of the shape {shape}")
    return values


def layers(
    content: Any, inputs: int, outputs: int, path: Path
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Return the arrays of a network with one hidden layer.

    Returns
    -------
    mean, scale : (inputs,)
        Inputs are standardised by them.
    hidden, bias : (inputs, h), (h,)
        Of the hidden layer.
    out_weights, out_bias : (h, outputs), (outputs,)
        Of the outputs.

    Raises
    ------
    IgripError
        If one is missing or has another shape, or a scale is not positive.
    """
    bias = numbers(content, ["bias"], (-1,), path)
    scale = numbers(content, ["scale"], (inputs,), path)
    if not (scale > 0.0).all():
        raise IgripError(f"{path}: scales must be positive")
    return (
        numbers(content, ["mean"], (inputs,), path), scale,
        numbers(content, ["hidden"], (inputs, len(bias)), path), bias,
        numbers(content, ["out_weights"], (len(bias), outputs), path),
        numbers(content, ["out_bias"], (outputs,), path),
    )  # fmt: skip
