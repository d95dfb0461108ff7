"""Reach detection in plain numpy: every sample anew from all samples before it, step by step."""

from __future__ import annotations

import numpy as np

STILL, STRAIGHT = 0.03, 0.5  # weights of zero velocity and acceleration, in samples


def kinematics(times, points, time_constant):
    """Return position, velocity and acceleration at the last sample, as rows.

    One dense weighted least squares of a parabola, with the two priors as rows.
    """
    age = (np.array(times) - times[-1]) / time_constant
    weight = np.sqrt(np.exp(age))
    design = np.stack([age**0, age, age**2], axis=1) * weight[:, None]
    prior = [[0.0, np.sqrt(STILL), 0.0], [0.0, 0.0, np.sqrt(STRAIGHT)]]
    target = np.concatenate([(points - points[-1]) * weight[:, None], np.zeros((2, 3))])
    c, *_ = np.linalg.lstsq(np.concatenate([design, prior]), target, rcond=None)
    return np.stack([c[0] + points[-1], c[1] / time_constant, 2.0 * c[2] / time_constant**2])


def noise_variances(times, points, memory, first):
    """Return the estimated variance after each sample.

    Four samples leave one degree of freedom beside a parabola: its squared residual, a mean over
    the axes, is one measurement of the variance; at most nine times the present estimate.
    """
    variance, found = first, []
    for k in range(len(times)):
        if k >= 3:
            t = (times[k - 3 : k + 1] - times[k]) / (times[k] - times[k - 3])
            design = np.stack([t**0, t, t**2], axis=1)
            four = points[k - 3 : k + 1] - points[k]
            c, *_ = np.linalg.lstsq(design, four, rcond=None)
            measured = min(((four - design @ c) ** 2).sum() / 3.0, 9.0 * variance)
            weight = max(1.0 / (k + 2.0), 1.0 - np.exp(-(times[k] - times[k - 1]) / memory))
            variance += weight * (measured - variance)
        found.append(variance)
    return found


class Reaches:
    """Follows one hand; ``config`` has the fields of a ReachConfig."""

    def __init__(self, config):
        self.config = config
        self.forget()

    def forget(self):
        self.times, self.samples = [], []
        self.moving, self.candidate, self.rested = False, False, 0
        self.slow = np.zeros(3)
        self.sway2 = self.config.initial_noise**2
        self.slow_since, self.points, self.path = None, [], 0.0
        self.max_speed = self.max_speed_t = 0.0

    def update(self, t, p):
        """Return what is known after a sample."""
        config = self.config
        if self.times and t - self.times[-1] > config.max_gap:
            self.forget()
        dt = t - self.times[-1] if self.times else 0.0
        self.times.append(t)
        self.samples.append(np.array(p, dtype=float))
        times, samples = np.array(self.times), np.array(self.samples)
        x, v, a = kinematics(times, samples, config.time_constant)
        self.variance = noise_variances(
            times, samples, config.rest_time_constant, config.initial_noise**2
        )[-1]
        self.slow += (1.0 - np.exp(-dt / config.end_time_constant)) * (v - self.slow)
        was_moving = self.moving
        begun = was_moving or self.leaves(t, p, x, v, dt)
        if begun is None:
            self.points = []
        else:
            self.follow(t, x, v, begun and not was_moving)
        return {
            "moving": self.moving, "onset": self.onset, "start": self.start,
            "variance": self.variance, "kinematics": np.stack([x, v, a]),
            "points": np.array(self.points).reshape(-1, 4), "path": self.path,
            "max_speed": self.max_speed, "max_speed_t": self.max_speed_t,
        }  # fmt: skip

    def leaves(self, t, p, x, v, dt):
        """Return True if it moves from now on, False if it may, None if it rests."""
        config = self.config
        if not self.rested:
            self.start, self.onset = np.array(p, dtype=float), t
        distance = np.linalg.norm(x - self.start)
        sway = min(config.onset_sway_factor * np.sqrt(self.sway2), config.max_onset_sway)
        noise = config.onset_noise_factor * np.sqrt(self.variance)
        threshold = max(config.onset_distance, noise, sway)
        if distance > threshold and (x - self.start) @ v > 0.0:
            before, self.candidate = self.candidate, True
            return bool(before or distance > 2.0 * threshold)
        self.candidate = False
        self.rested += 1
        near = distance < 0.5 * threshold
        if near:
            self.onset = t
        memory = config.rest_time_constant
        spread = 1.0 - np.exp(-0.5 * dt / memory)
        if near:
            spread = max(spread, 1.0 / (self.rested + 4.0))
        self.sway2 += spread * (min(distance, threshold) ** 2 / 3.0 - self.sway2)
        place = max(1.0 - np.exp(-dt / memory), 1.0 / self.rested)
        self.start = self.start + place * (p - self.start)
        return None if near else False

    def follow(self, t, x, v, begins):
        """Add a sample to the movement, or end it."""
        config, speed = self.config, np.linalg.norm(v)
        if not self.points:
            self.path, self.max_speed, self.last = 0.0, 0.0, self.start
        if begins:
            self.moving, self.slow_since = True, None
        if speed > self.max_speed:
            self.max_speed, self.max_speed_t = speed, t
        rest_speed = max(
            config.rest_speed,
            config.rest_speed_fraction * self.max_speed,
            config.rest_noise_factor * np.sqrt(self.variance) / config.end_time_constant,
        )
        if self.moving and np.linalg.norm(self.slow) < rest_speed:
            self.slow_since = t if self.slow_since is None else self.slow_since
            if t - self.slow_since >= config.min_rest_duration:
                self.moving, self.candidate, self.rested = False, False, 1
                self.onset, self.start, self.points = t, x, []
                return
        else:
            self.slow_since = None
        self.path += np.linalg.norm(x - self.last)
        self.last = x
        self.points.append([t, *x])
