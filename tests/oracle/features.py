"""Features of a movement by their names, in plain numpy, one object at a time."""

from __future__ import annotations

import numpy as np

AHEAD, PART_OF_HALF_LENGTH, BOUND, TINY = 0.12, 0.7, 8.0, 1e-12


def cosine(a, b):
    return a @ b / (np.linalg.norm(a) * np.linalg.norm(b) + TINY)


def bounded(named):
    return {name: np.clip(value, -BOUND, BOUND) for name, value in named.items()}


def point_before(points, start, distance):
    """Return the last point of the movement that was nearer to its start than a distance."""
    nearer = np.flatnonzero(np.linalg.norm(points[:, 1:] - start, axis=1) < distance)
    return points[nearer[-1] if len(nearer) else 0]


class Movement:
    """A movement so far.

    Parameters
    ----------
    now : (3, 3)
        Rows position, velocity, acceleration.
    times : 3 floats
        Of the sample, the onset and the highest speed.
    start, points, max_speed, path, noise
        As a ReachState has them; ``noise`` is the standard deviation.
    """

    def __init__(self, now, times, start, points, max_speed, path, noise):
        self.x, self.v, self.a = now
        self.t, self.onset, self.peak_t = times
        self.start, self.points = start, points
        self.max_speed, self.path, self.noise = max_speed, path, noise
        self.elapsed = max(self.t - self.onset, 1e-3)
        self.speed = np.linalg.norm(self.v)
        self.covered = np.linalg.norm(self.x - start)
        self.gain = self.a @ self.v / (self.speed + TINY)  # of speed, in time
        self.quarter, self.half, self.three_quarters = (
            point_before(points, start, part * self.covered) for part in (0.25, 0.5, 0.75)
        )

    def shared(self):
        covered, since = self.covered + TINY, self.t - self.half[0]
        return bounded({
            "speed_of_peak": self.speed / (self.max_speed + TINY),
            "speed_time_covered": self.speed * self.elapsed / covered,
            "braking_time": self.gain * self.elapsed / (self.speed + TINY),
            "path_excess": self.path / covered,
            "peak_when": (self.peak_t - self.onset) / self.elapsed,
            "speed_since_quarter": self.speed * (self.t - self.quarter[0]) / covered,
            "speed_since_half": self.speed * since / covered,
            "half_of_quarter": since / (self.t - self.quarter[0] + 1e-3),
            "speed_since_three_quarters": self.speed * (self.t - self.three_quarters[0]) / covered,
            "bend_since_half": self.gain * since**2 / covered,
            "noise_of_way": self.noise / covered,
        })  # fmt: skip

    def local(self, centre, axis, half_length, radius, velocity):
        """Return the features of one object, but for its nearness, and what remains to it [m]."""
        ahead = self.x + AHEAD * self.v + 0.5 * AHEAD**2 * self.a
        limit = PART_OF_HALF_LENGTH * half_length
        aim = centre + np.clip((ahead - centre) @ axis, -limit, limit) * axis
        left, way = aim - self.x, aim - self.start
        remaining, length = np.linalg.norm(left), np.linalg.norm(way)
        done = (self.x - self.start) @ way
        lately, finally_ = self.x - self.half[1:], self.x - self.three_quarters[1:]
        size = radius + half_length
        named = {
            "remaining": remaining / length,
            "log_remaining": np.log((remaining + 0.05 * length) / (1.05 * length)),
            "progress": done / length**2,
            "deviation": np.sqrt(max(0.0, self.covered**2 - (done / length) ** 2)) / length,
            "heading_now": cosine(self.v, left),
            "heading_so_far": done / (self.covered * length),
            "speed_time": self.speed * self.elapsed / length,
            "peak_time": self.max_speed * self.elapsed / length,
            "miss_ahead": np.linalg.norm(aim - ahead) / length,
            "miss_now": remaining * np.sqrt(1.0 - cosine(self.v, left) ** 2) / length,
            "remaining_to_surface": max(remaining - radius, 0.0) / length,
            "object_speed": np.linalg.norm(velocity) / self.speed,
            "heading_lately": cosine(lately, left),
            "miss_lately": remaining * np.sqrt(1.0 - cosine(lately, left) ** 2) / length,
            "acceleration_towards": cosine(self.a, left),
            "distance_covered": self.covered / length,
            "path_covered": self.path / length,
            "heading_last": cosine(finally_, left),
            "braking": self.gain * self.elapsed**2 / length,
            "remaining_of_size": np.log((remaining + 0.2 * size) / size),
            "heading_relative": cosine(self.v - velocity, left),
        }  # fmt: skip
        return bounded(named), remaining

    def all_local(self, cylinders):
        """Return the features of all objects, each of them a named mapping."""
        found = [self.local(*one) for one in zip(*cylinders, strict=True)]
        nearest = min(remaining for _, remaining in found)
        return [
            named | {"nearness": np.log((nearest / remaining + 0.1) / 1.1)}
            for named, remaining in found
        ]
