"""Which grip fits what a hand finds between its fingers.

Rules on sizes, from the taxonomy's own descriptions (Feix et al. 2016, Table II: opposition by palm
or pad, size and shape of the object); the borders are round numbers of an adult's hand, no fit to
data. An elongated object that is met at its end is gripped by the fingers, as in the paper's
Figure 2: the palm lies over the end, and the fingers along the sides.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.grasps.candidate import CLEARANCE
from igrip.grasps.hand_fit import HandFits
from igrip.grasps.opposition import MAX_OPENING
from igrip.objects.model import ObjectModel
from igrip.taxonomy import GRIP_TYPES, NAMES

Array = NDArray[np.float64]

HAND = 0.05  # m; the breadth that three fingers need
THICK, THIN, SHEET = 0.05, 0.015, 0.012  # m; openings
WIRE, BAR = 0.005, 0.045  # m; a handle is no thinner and no deeper
KNOB = 0.045  # m
PALM_REACH = 0.05  # m; from the palm, with the fingers round the middle
LARGE_SHEET = 0.06  # m; of a plate ahead of the fingertips
END = np.cos(np.radians(35.0))  # an approach within this angle of the long axis meets an end
BEYOND_END = 0.85  # half-lengths; paper: Figure 2, decision 0013
ELONGATED = 1.15  # length over diameter from which an object has ends
ROUND = 0.2  # extents of a ball differ by no more than this part
CURVED = 0.88  # of its opening: so far at most are its sides as wide as at the contacts
FLAT = 0.9
DEEP, TIP = 0.045, 0.015  # m; best depth of the contacts in power and in precision grips
DEPTH_SPREAD, LENGTH_SPREAD = 0.02, 0.03  # m
NARROW = 0.02  # m
FACING_SPREAD = 0.08  # of the cosine
EASY = 0.03  # m; openings within this of the widest are taken less readily


def classify(fits: HandFits, model: ObjectModel) -> tuple[NDArray[np.int64], Array]:
    """Return the grip of each hand that fits, and how well it sits.

    Returns
    -------
    grip : (g,)
        Index in :data:`igrip.taxonomy.NAMES`.
    weight : (g,)
        From 0 to 1: contacts that oppose, at a good depth, in the middle of the part, with the
        palm flat on it.
    """
    back, front, below, above, tall, sides, beyond, planar, facing, _ = fits.features.T
    width, depth, long = fits.opening, back + front, below + above
    end_on = np.abs(fits.approach @ model.axis) > END
    palm = fits.centre - (back + CLEARANCE)[:, None] * fits.approach
    end_on |= np.abs((palm - model.origin) @ model.axis) >= BEYOND_END * 0.5 * model.length
    end_on &= model.length > ELONGATED * 2.0 * model.radius
    held = (long >= HAND) & (back <= PALM_REACH) & (width >= THIN) & ~end_on
    round_ = np.abs(np.stack([tall, depth]) / np.maximum(width, 1e-9) - 1.0).max(axis=0) < ROUND
    thin = width <= SHEET
    rules = {
        "hook": (width <= BAR)
        & (np.minimum(width, depth) >= WIRE)
        & (depth <= BAR)
        & (beyond > 0.0)
        & (long >= 0.5 * HAND),
        "power_sphere": round_
        & ~end_on
        & (np.maximum(long, sides) < CURVED * width)
        & (back <= PALM_REACH)
        & (width >= KNOB),
        "palmar": held & (width > THICK),
        "medium_wrap": held,
        "flat": thin & (planar >= FLAT) & (front >= LARGE_SHEET) & (long >= HAND),
        "lateral": thin & (planar >= FLAT) & (long >= 2.0 * width) & (front < LARGE_SHEET),
        "tripod": (width <= KNOB) & ~thin & (np.abs(tall / np.maximum(width, 1e-9) - 1.0) < 0.4),
    }
    order = list(rules)
    chosen = np.select(list(rules.values()), [NAMES.index(name) for name in order],
                       NAMES.index("pinch"))  # fmt: skip
    power = np.array([GRIP_TYPES[name].family == "power" for name in NAMES])[chosen]
    best = np.where(power, np.minimum(0.5 * depth, DEEP), np.minimum(0.5 * depth, TIP))
    uneven = np.minimum(np.abs(above - below) / 2.0, HAND)
    # the normals of what is small say little
    facing = np.where((width < NARROW) & (long < HAND), 1.0, facing)
    weight = (
        (0.2 + 0.8 * fits.quality)
        * np.exp(-(((back - best) / DEPTH_SPREAD) ** 2))
        * np.exp(-((uneven / LENGTH_SPREAD) ** 2))
        * (0.02 + 0.98 * np.exp(-((np.minimum(1.0 - facing, 0.5) / FACING_SPREAD) ** 2)))
        * np.clip((MAX_OPENING - width) / EASY, 0.05, 1.0)
    )
    return chosen.astype(np.int64), weight
