"""What the page gets: an intention as a row of numbers, a snapshot as lists, a mesh as bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.describe import headline
from igrip.geometry.scene import PlacedObject
from igrip.intention import Intention
from igrip.viewer.snapshot import HandSnapshot, Snapshot, rays_of

Array = NDArray[np.float64]
DIGITS = 5  # of probabilities and scores; a page shows fewer
RAY_STEP = 2  # every second ray is drawn: all of them would hide the target


def row_of(intention: Intention, speed: float | None, assisted: bool) -> dict[str, Any]:
    """Return what the page shows of an intention; what is unknown is left out.

    Times are on the clock of the messages [s], ``speed`` in m/s. ``subject`` is the target while
    it is likelier than ``none``, ``target`` the likeliest object in any case.
    """
    verb, subject = headline(intention)
    lease = intention.commitment
    row = {
        "hand": intention.hand, "t": intention.t, "status": intention.status, "verb": verb,
        "subject": subject, "reason": intention.reason, "target": intention.target,
        "p": intention.probability, "confidence": intention.confidence, "grip": intention.grip,
        "grip_p": intention.grip_probability, "contact_in": intention.time_to_contact,
        "contact_interval": intention.time_to_contact_interval, "speed": speed,
        "scores": intention.scores or None, "assisted": assisted,
        "lease": lease and {
            "target": lease.target, "grip": lease.grip, "valid_until": lease.valid_until,
        },
    }  # fmt: skip
    return {name: _rounded(value) for name, value in row.items() if value is not None}


def row_of_hand(hand: HandSnapshot) -> dict[str, Any]:
    """Return the row of a hand's newest intention."""
    speed = None if hand.motion is None else hand.motion.speed
    return row_of(hand.intention, speed, hand.assisted)


def scene_of(snapshot: Snapshot, mesh_of: dict[str, int]) -> dict[str, Any]:
    """Return what is drawn of a snapshot in three dimensions, and the newest row of each hand.

    ``mesh_of`` gives the number of each model's mesh.
    """
    return {
        "t": snapshot.t,
        "objects": [_placed(placed, mesh_of) for placed in snapshot.objects],
        "hands": [_hand(snapshot, hand) for hand in snapshot.hands],
        "rows": [row_of_hand(hand) for hand in snapshot.hands],
    }


def encode_mesh(vertices: Array, faces: NDArray[Any]) -> bytes:
    """Return a mesh as the page reads it.

    Two counts (vertices and faces), positions, normals (32-bit floats), corners (32-bit unsigned),
    all little-endian. Corners at one place share their normal, so that an outline has no cracks.
    """
    _, place = np.unique(np.round(vertices, 6), axis=0, return_inverse=True)
    place = place.reshape(-1)
    corners = vertices[faces]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros((place.max(initial=-1) + 1, 3))
    for k in range(3):
        np.add.at(sums, place[faces[:, k]], areas)
    normals = sums[place]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    head = np.array([len(vertices), len(faces)], "<u4")
    parts = (head, vertices.astype("<f4"), normals.astype("<f4"), faces.astype("<u4"))
    return b"".join(part.tobytes() for part in parts)


def _placed(placed: PlacedObject, mesh_of: dict[str, int]) -> dict[str, Any]:
    model = placed.model
    up = 1.0 if (placed.rotation @ model.axis)[2] >= 0.0 else -1.0
    top = model.origin + up * (0.5 * model.length + 0.01) * model.axis
    centre = placed.rotation @ model.origin + placed.translation
    return {
        "id": placed.id, "mesh": mesh_of[model.name],
        "position": _numbers(placed.translation),
        "orientation": _numbers(Rotation.from_matrix(placed.rotation).as_quat()),
        "top": _numbers(placed.rotation @ top + placed.translation),
        "centre": _numbers(centre), "radius": round(float(np.hypot(0.5 * model.length,
                                                                   model.radius)), 4),
    }  # fmt: skip


def _hand(snapshot: Snapshot, hand: HandSnapshot) -> dict[str, Any]:
    moving = hand.motion is not None and hand.intention.status == "reaching"
    future = hand.motion.future if hand.motion is not None and moving else np.empty((0, 3))
    hits, misses = rays_of(snapshot.scene, hand) if moving else (np.empty((0, 2, 3)),) * 2
    return {
        "id": hand.intention.hand, "position": _numbers(hand.past[-1]) if len(hand.past) else None,
        "past": _numbers(hand.past[:-1]), "future": _numbers(future),
        "hits": _numbers(hits[::RAY_STEP]), "misses": _numbers(misses[::RAY_STEP]),
    }  # fmt: skip


def _numbers(values: Array) -> list[float]:
    """Return numbers in one list, in a tenth of a millimetre."""
    flat: list[float] = np.round(np.asarray(values, dtype=np.float64).ravel(), 4).tolist()
    return flat


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, DIGITS)
    if isinstance(value, dict):
        return {name: _rounded(inner) for name, inner in value.items() if inner is not None}
    if isinstance(value, list | tuple):
        return [_rounded(inner) for inner in value]
    return value
