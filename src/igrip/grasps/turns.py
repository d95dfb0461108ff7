"""Turns about an axis: grasps that differ by one alone are the same grasp.

A can is grasped from any side, a mug from any but that of its handle. Each hand that fits is turned
about an axis of the object until its palm lies in one half-plane; those that then coincide, at
turns that fill an arc, are one candidate with that arc.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.grasps.candidate import ON_AXIS
from igrip.grasps.hand_fit import HandFits
from igrip.grasps.surface import Surface
from igrip.objects.model import ObjectModel

Array = NDArray[np.float64]

PALM_DISTANCE = 0.1  # m; from the contacts to the point whose azimuth is turned to 0
SECTORS = 24
MIN_SECTORS = 8  # 120°
FULL = 20  # with so many the arc is the whole circle; noise leaves gaps


class Line(NamedTuple):
    """An axis: a point on it, (3,) [m], and unit vectors along and, by columns, (3, 3)."""

    point: Array
    frame: Array  # columns x, y, and z along it


def lines_of(surface: Surface, model: ObjectModel) -> list[Line]:
    """Return the axes that parts may be turned about, that of the object's cylinder first.

    They have the directions of the object frame. Where an axis of revolution lies, the normals
    lead: they meet it. It is found by least squares, with weights that leave out other parts.
    """
    rotation = model.mesh_from_object[:3, :3]
    lines = []
    for k in (2, 0, 1):
        frame = np.roll(rotation, 2 - k, axis=1)
        point = model.origin
        if not (k == 2 and model.symmetry == "cylinder"):
            point = _centre_of_revolution(surface, frame, model.origin)
        lines.append(Line(point, frame))
    return lines


def _centre_of_revolution(surface: Surface, frame: Array, start: Array) -> Array:
    """Return the point of the plane across an axis that most lines along normals pass by."""
    flat, normals = (surface.points - start) @ frame[:, :2], surface.normals @ frame[:, :2]
    steep = np.linalg.norm(normals, axis=1)
    used = steep > 0.5
    if used.sum() < 10:
        return start
    flat, normals = flat[used], normals[used] / steep[used, None]
    across = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    centre = np.zeros(2)
    offset = np.einsum("ni,ni->n", across, flat)
    for _ in range(12):
        weight = 1.0 / (1.0 + ((across @ centre - offset) / 0.004) ** 2)
        weighted = across * weight[:, None]
        matrix = weighted.T @ across + 1e-6 * np.eye(2)
        centre = np.linalg.solve(matrix, weighted.T @ offset)
    return start + frame[:, :2] @ np.clip(centre, -0.3, 0.3)


class Turned(NamedTuple):
    """Hands turned into one half-plane of a line; vectors in its frame.

    Attributes
    ----------
    centre, approach, closing : (g, 3)
        As in :class:`igrip.grasps.hand_fit.HandFits`, turned; the centre from the line's point.
    turn : (g,)
        By which each was turned [rad].
    """

    centre: Array
    approach: Array
    closing: Array
    turn: Array


def turn_to(line: Line, fits: HandFits) -> Turned:
    """Turn hands about a line until their palms lie in the half-plane x > 0 of its frame."""
    centre = (fits.centre - line.point) @ line.frame
    approach, closing = fits.approach @ line.frame, fits.closing @ line.frame
    palm = centre - PALM_DISTANCE * approach
    turn = np.arctan2(palm[:, 1], palm[:, 0])
    on_axis = np.hypot(palm[:, 0], palm[:, 1]) < ON_AXIS
    # a palm on the axis has no azimuth; the closing direction has, and its opposite is as good
    half = np.arctan2(closing[:, 1], closing[:, 0])
    turn = np.where(on_axis, half, turn)
    back = _about_z(-turn)
    return Turned(
        np.einsum("gij,gj->gi", back, centre), np.einsum("gij,gj->gi", back, approach),
        np.einsum("gij,gj->gi", back, closing), turn,
    )  # fmt: skip


def _about_z(angle: Array) -> Array:
    """Return rotations about z, shape (g, 3, 3)."""
    cos, sin = np.cos(angle), np.sin(angle)
    turns = np.zeros((len(angle), 3, 3))
    turns[:, 0, 0], turns[:, 0, 1], turns[:, 1, 0], turns[:, 1, 1] = cos, -sin, sin, cos
    turns[:, 2, 2] = 1.0
    return turns


def arc_of(turns: Array, weight: Array) -> tuple[float, float]:
    """Return middle and half-width of the arc that turns fill [rad]; half-width 0: no arc.

    A sector counts as filled if it has a fair share of the weight: the flat sides of a box, each
    grasped within the friction cone of its normal, fill none of the sectors between them.
    """
    sector = np.floor((turns % (2.0 * np.pi)) / (2.0 * np.pi) * SECTORS).astype(int) % SECTORS
    share = np.bincount(sector, weight, SECTORS)
    filled = share > 0.25 * share.sum() / SECTORS
    smooth = filled | (np.roll(filled, 1) & np.roll(filled, -1))  # single gaps
    if smooth.sum() >= FULL:
        return 0.0, float(np.pi)
    twice = np.concatenate([smooth, smooth]).tolist()
    best = run = end = 0
    for k, is_filled in enumerate(twice):
        run = run + 1 if is_filled else 0
        if run > best:
            best, end = run, k
    if best < MIN_SECTORS:
        return 0.0, 0.0
    step = 2.0 * np.pi / SECTORS
    middle = (end + 1 - 0.5 * best) * step
    return float(middle % (2.0 * np.pi)), float(0.5 * best * step)
