"""One step of the One-Euro filters, compiled: a scene has many objects, and each takes two steps.

See :mod:`igrip.motion.filters` for the filter.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.entities import Quaternion, Vector

Array = NDArray[np.float64]

# layout of the state, used in this file and by trajectory_kernel.py alone: value (4, the last
# unused for a point), derivative (3), velocity (3), time of the last sample; and of the parameters
VALUE, DERIVATIVE, VELOCITY, TIME, SIZE = 0, 4, 7, 10, 11
MIN_CUTOFF, BETA, DERIVATIVE_CUTOFF = 0, 1, 2


def new_filter(min_cutoff: float, beta: float, derivative_cutoff: float) -> tuple[Array, Array]:
    """Return the state of a filter before its first sample, and its parameters: (11,), (3,)."""
    return np.zeros(SIZE), np.array([min_cutoff, beta, derivative_cutoff])


def begin(state: Array, t: float, value: tuple[float, ...]) -> None:
    """Start a filter with its first sample: a point [m] or a unit quaternion at ``t`` [s]."""
    state[VALUE : VALUE + len(value)] = value
    state[TIME] = t


def point_of(state: Array) -> Vector:
    """Return the filtered point [m]."""
    x, y, z = state[VALUE : VALUE + 3].tolist()
    return (x, y, z)


def quaternion_of(state: Array) -> Quaternion:
    """Return the filtered rotation, a unit quaternion x, y, z, w."""
    x, y, z, w = state[VALUE : VALUE + 4].tolist()
    return (x, y, z, w)


def derivative_of(state: Array) -> Vector:
    """Return the low-passed derivative, which drives the cutoff [m/s or rad/s]."""
    x, y, z = state[DERIVATIVE : DERIVATIVE + 3].tolist()
    return (x, y, z)


def velocity_of(state: Array) -> Vector:
    """Return the low-passed velocity of the filtered value [m/s or rad/s]."""
    x, y, z = state[VELOCITY : VELOCITY + 3].tolist()
    return (x, y, z)


@kernel
def smoothing(cutoff, dt):
    """Return the weight of a new sample in a first-order low-pass (Casiez et al. 2012, eq. 5)."""
    tau = 1.0 / (2.0 * math.pi * cutoff)
    return 1.0 / (1.0 + tau / dt)


@kernel
def _advance(state, t, x, y, z, parameters):
    """Use the step from the filtered value to a new sample; return the weight of the sample."""
    dt = t - state[TIME]
    state[TIME] = t
    weight = smoothing(parameters[DERIVATIVE_CUTOFF], dt)
    x, y, z = x / dt, y / dt, z / dt
    state[DERIVATIVE] += weight * (x - state[DERIVATIVE])
    state[DERIVATIVE + 1] += weight * (y - state[DERIVATIVE + 1])
    state[DERIVATIVE + 2] += weight * (z - state[DERIVATIVE + 2])
    speed = math.sqrt(
        state[DERIVATIVE] ** 2 + state[DERIVATIVE + 1] ** 2 + state[DERIVATIVE + 2] ** 2
    )
    part = smoothing(parameters[MIN_CUTOFF] + parameters[BETA] * speed, dt)
    state[VELOCITY] += weight * (part * x - state[VELOCITY])
    state[VELOCITY + 1] += weight * (part * y - state[VELOCITY + 1])
    state[VELOCITY + 2] += weight * (part * z - state[VELOCITY + 2])
    return part


@kernel
def step_position(state, t, x, y, z, parameters):
    """Filter a point [m] measured at ``t`` [s]; :func:`point_of` has the result."""
    x, y, z = x - state[VALUE], y - state[VALUE + 1], z - state[VALUE + 2]
    part = _advance(state, t, x, y, z, parameters)
    state[VALUE] += part * x
    state[VALUE + 1] += part * y
    state[VALUE + 2] += part * z


@kernel
def step_orientation(state, t, x, y, z, w, parameters):
    """Filter a unit quaternion at ``t`` [s]; :func:`quaternion_of` has the result."""
    # the turn from the filtered rotation to the new one, in the world: new · old⁻¹
    ox, oy, oz, ow = state[VALUE], state[VALUE + 1], state[VALUE + 2], state[VALUE + 3]
    tx = -w * ox + x * ow - y * oz + z * oy
    ty = -w * oy + x * oz + y * ow - z * ox
    tz = -w * oz - x * oy + y * ox + z * ow
    tw = w * ow + x * ox + y * oy + z * oz
    if tw < 0.0:  # the shorter way round
        tx, ty, tz, tw = -tx, -ty, -tz, -tw
    sine = math.sqrt(tx * tx + ty * ty + tz * tz)
    scale = 2.0 if sine < 1e-9 else 2.0 * math.atan2(sine, tw) / sine
    tx, ty, tz = scale * tx, scale * ty, scale * tz
    part = _advance(state, t, tx, ty, tz, parameters)
    # part of that turn, then the old rotation
    tx, ty, tz = part * tx, part * ty, part * tz
    angle = math.sqrt(tx * tx + ty * ty + tz * tz)
    half = 0.5 - angle * angle / 48.0 if angle < 1e-4 else math.sin(0.5 * angle) / angle
    tx, ty, tz, tw = half * tx, half * ty, half * tz, math.cos(0.5 * angle)
    nx = tw * ox + tx * ow + ty * oz - tz * oy
    ny = tw * oy - tx * oz + ty * ow + tz * ox
    nz = tw * oz + tx * oy - ty * ox + tz * ow
    nw = tw * ow - tx * ox - ty * oy - tz * oz
    norm = math.sqrt(nx * nx + ny * ny + nz * nz + nw * nw)
    state[VALUE], state[VALUE + 1] = nx / norm, ny / norm
    state[VALUE + 2], state[VALUE + 3] = nz / norm, nw / norm


@kernel
def step_pose(states, parameters, t, x, y, z, qx, qy, qz, qw):
    """Take both steps in one call; the quaternion need not be of unit length.

    Parameters
    ----------
    states, parameters : (2, 11), (2, 3)
        Of the filters of the position and of the orientation; the states are changed.
    t, x, y, z, qx, qy, qz, qw : float
        The sample [s, m].
    """
    step_position(states[0], t, x, y, z, parameters[0])
    n = math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
    step_orientation(states[1], t, qx / n, qy / n, qz / n, qw / n, parameters[1])


@kernel
def place_point(states, local, rest_speed, out):
    """Write a filtered pose as matrices, with a point of the object and its velocity.

    Parameters
    ----------
    states : (2, 11)
        Of the filters of the position and of the orientation.
    local : (3,)
        A point of the object, in its own frame [m].
    rest_speed : float
        A slower object rests: its velocity is zero [m/s].
    out : (6, 3), written
        Rotation by rows, translation, the point in the world [m], its velocity [m/s].
    """
    position, orientation = states[0], states[1]
    x, y, z, w = orientation[0], orientation[1], orientation[2], orientation[3]
    out[0, 0], out[0, 1] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z)
    out[0, 2], out[1, 0] = 2.0 * (x * z + w * y), 2.0 * (x * y + w * z)
    out[1, 1], out[1, 2] = 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    out[2, 0], out[2, 1] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x)
    out[2, 2] = 1.0 - 2.0 * (x * x + y * y)
    lever = np.empty(3)
    for axis in range(3):
        lever[axis] = out[axis, 0] * local[0] + out[axis, 1] * local[1] + out[axis, 2] * local[2]
        out[3, axis] = position[axis]
        out[4, axis] = position[axis] + lever[axis]
    v = position[VELOCITY : VELOCITY + 3]
    a, b, c = orientation[VELOCITY], orientation[VELOCITY + 1], orientation[VELOCITY + 2]
    out[5, 0] = v[0] + b * lever[2] - c * lever[1]
    out[5, 1] = v[1] + c * lever[0] - a * lever[2]
    out[5, 2] = v[2] + a * lever[1] - b * lever[0]
    if out[5, 0] ** 2 + out[5, 1] ** 2 + out[5, 2] ** 2 < rest_speed * rest_speed:
        out[5] = 0.0
