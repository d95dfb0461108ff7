"""The palm of an arm, from the shape of its end: a learned regression.

It asks for no fingers: a fist, a mitten, a splint or a hook end an arm as well. The network learned
from rendered arms of many kinds (``python -m training.palm``; docs/hands.md).
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from igrip.learned_weights import layers, numbers, read_learned
from igrip.perception.arms.end_shape import INPUTS, end_shape
from igrip.rgbd import Array

FORMAT = "igrip-palm/1"
FILE = Path(__file__).with_name("palm.json")
# m; the palm is put so far from the middle of the hand, which the network learned, towards the
# camera: other detectors measure the skin, and a hand has one place (docs/hands.md)
TO_SKIN = 0.005
MAX_INPUT = 3.0  # standardised inputs are bounded: other arms are not extrapolated to
OUTPUTS = 3


class ArmEnd(NamedTuple):
    """Where an arm ends, in the frame of the table [m]."""

    palm: Array  # (3,)
    tip: Array  # (3,)
    along: Array  # (3,), unit vector from the arm to the tip
    std: float  # of the palm, each axis


class PalmModel(NamedTuple):
    """The network, with one hidden layer of tanh units.

    Attributes
    ----------
    mean, scale : (83,)
        Inputs are standardised by them, and bounded to ±3.
    hidden : (83, h), bias : (h,)
        Of the hidden layer.
    out_weights : (h, 3), out_bias : (3,)
        Of the outputs: the palm from the tip, in the frame of the end [m].
    std : (1,)
        Of the palm, each axis, on kinds of arms that it did not learn from [m].
    """

    mean: Array
    scale: Array
    hidden: Array
    bias: Array
    out_weights: Array
    out_bias: Array
    std: Array

    def palm(self, inputs: Array) -> Array:
        """Return the palm from the tip, (…, 3) [m], from the inputs of an end, (…, 83)."""
        z = np.clip((inputs - self.mean) / self.scale, -MAX_INPUT, MAX_INPUT)
        palm: Array = np.tanh(z @ self.hidden + self.bias) @ self.out_weights + self.out_bias
        return palm


@cache
def palm_model() -> PalmModel:
    """Return the network that ships."""
    return read_palm(FILE)


def read_palm(path: Path) -> PalmModel:
    """Read a network.

    Raises
    ------
    IgripError
        If the file is none.
    """
    content = read_learned(path, FORMAT)
    std = numbers(content, ["std"], (1,), path)
    return PalmModel(*layers(content, INPUTS, OUTPUTS, path), std)


def arm_end(points: Array, entry: Array, camera: Array) -> ArmEnd | None:
    """Return where an arm ends; None if too little of it is measured.

    Parameters
    ----------
    points : (n, 3)
        Of the arm's surface.
    entry : (3,)
        Where it comes in.
    camera : (3,)
        Where the camera is.
    """
    shape = end_shape(points, entry, camera)
    if shape is None:
        return None
    model = palm_model()
    middle = shape.tip + model.palm(shape.inputs) @ shape.frame
    to_camera = (camera - middle) / np.linalg.norm(camera - middle)
    palm = middle + TO_SKIN * to_camera
    return ArmEnd(palm, shape.tip, -shape.frame[0], float(model.std[0]))
