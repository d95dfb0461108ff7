"""The whole way from messages to scores, target and grip, for healthy input.

The oracle knows nothing of health: it wants measurements that are fresh, in order and do not jump.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from oracle import cones, filters, meshes, motion, scores

HAND = {"min_cutoff": 1.5, "beta": 5.0, "derivative_cutoff": 1.0}
OBJECT_POSITION = {"min_cutoff": 1.0, "beta": 5.0, "derivative_cutoff": 1.0}
OBJECT_ORIENTATION = {"min_cutoff": 1.0, "beta": 1.0, "derivative_cutoff": 1.0}
WINDOW, DURATION = 20, 1.0
POINTS, HORIZON = 10, 0.3
STILL = 0.05


@dataclass
class Pose:
    """One object at one time: its mesh, world-from-mesh pose, centre and its velocity."""

    mesh: meshes.Mesh
    rotation: np.ndarray
    translation: np.ndarray
    centre: np.ndarray
    velocity: np.ndarray

    def to_mesh(self, point):
        return (point - self.translation) @ self.rotation

    def to_world(self, point):
        return self.rotation @ point + self.translation


def measure(position, coefficients, pose, rays=cones.RAYS):
    """Return the metrics of one hand and one object, and how clear the nearest ray was."""
    points, velocities = motion.future(coefficients, POINTS, HORIZON)
    barycentre = points.mean(axis=0)
    hits, clearest = 0, np.inf
    z = pose.mesh.axis
    x = np.eye(3)[np.argmin(np.abs(z))]  # only for a cone that points straight at the object
    for point, velocity in zip(points, velocities, strict=True):
        if np.linalg.norm(velocity) < cones.SLOW_SPEED:
            continue
        apex, turned = pose.to_mesh(point), velocity @ pose.rotation
        rays_of_cone = cones.directions(apex, turned, pose.mesh.middle, (z, x), rays)
        margins = meshes.cone_margins(pose.mesh, apex, rays_of_cone)
        hits += int((margins >= 0.0).sum())
        clearest = min(clearest, float(np.abs(margins).min()))
    away = position - pose.centre
    here, there = pose.to_mesh(position), pose.to_mesh(barycentre)
    return {
        "hits": hits,
        "clearest": clearest,
        "vertex": meshes.nearest_vertex(pose.mesh, here),
        "surface": meshes.nearest_surface(pose.mesh.corners, here)[0],
        "future_vertex": meshes.nearest_vertex(pose.mesh, there),
        "future_surface": meshes.nearest_surface(pose.mesh.corners, there)[0],
        "centre": float(np.linalg.norm(away)),
        "centre_rate": float(
            away @ (coefficients[1] - pose.velocity) / max(np.linalg.norm(away), 1e-9)
        ),
        "axial": pose.mesh.axial(here),
    }


def decide(result, distance="vertex"):
    """Return a result of :func:`run` with scores, targets and grips for one kind of distance."""
    metrics, speed, peak = result["metrics"], result["speed"], result["peak"]
    column = {name: np.array([m[name] for m in metrics]) for name in metrics[0]}
    found = {
        "impacts": scores.impacts(column["hits"]),
        "distance_derivative": scores.distance_derivative(column["centre_rate"], speed),
        "distance": scores.closeness(column[distance], result["centres"]),
        "future_distance": scores.closeness(column[f"future_{distance}"], result["centres"]),
    }
    for kind in ("paper", "repaired"):
        found[kind] = scores.combined(kind, found, speed, peak)
    targets = {name: scores.target(values) for name, values in found.items()}
    grips = {
        name: None if k is None else scores.grip(metrics[k]["axial"], result["lengths"][k])
        for name, k in targets.items()
    }
    return {**result, "scores": found, "targets": targets, "grips": grips}


def hand_tracks(messages):
    """Return by hand the index of message, time and raw position of each measurement."""
    tracks = {}
    for index, message in enumerate(messages):
        for id, hand in message.get("hands", {}).items():
            if hand is not None:
                t = hand.get("t", message["t"])
                tracks.setdefault(id, []).append((index, t, hand["position"]))
    return tracks


def object_poses(messages, mesh_of):
    """Return by object the poses after each of its measurements, as (index of message, Pose)."""
    seen, models = {}, {}
    for index, message in enumerate(messages):
        for id, pose in message.get("objects", {}).items():
            if pose is None:
                continue
            models.setdefault(id, pose.get("model"))
            row = (index, pose.get("t", message["t"]), pose["position"], pose["orientation"])
            seen.setdefault(id, []).append(row + (pose.get("static", False),))
    result = {}
    for id, rows in seen.items():
        mesh = mesh_of[models[id]]
        times = [row[1] for row in rows]
        points, _, v = filters.one_euro_points(times, [row[2] for row in rows], **OBJECT_POSITION)
        turns, _, w = filters.one_euro_rotations(
            times, [row[3] for row in rows], **OBJECT_ORIENTATION
        )
        result[id] = []
        for k, row in enumerate(rows):
            rotation = turns[k].as_matrix()
            lever = rotation @ mesh.centre
            velocity = v[k] + np.cross(w[k], lever)
            if row[4] or np.linalg.norm(velocity) < STILL:
                velocity = np.zeros(3)
            result[id].append(
                (row[0], Pose(mesh, rotation, points[k], points[k] + lever, velocity))
            )
    return result


def run(messages, mesh_of, wanted=lambda index: True):
    """Return {(index of message, hand): metrics} for the measurements that are ``wanted``."""
    poses = object_poses(messages, mesh_of)
    results = {}
    for hand, rows in hand_tracks(messages).items():
        times = [row[1] for row in rows]
        filtered, _, _ = filters.one_euro_points(times, [row[2] for row in rows], **HAND)
        moving = motion.motions(times, filtered, size=WINDOW, duration=DURATION)
        for k, row in enumerate(rows):
            index = row[0]
            if moving[k] is None or not wanted(index):
                continue
            coefficients, speed, peak = moving[k]
            now = {
                id: [pose for at, pose in history if at <= index][-1]
                for id, history in poses.items()
                if history[0][0] <= index
            }
            results[index, hand] = {
                "ids": list(now),
                "position": filtered[k],
                "coefficients": coefficients,
                "speed": speed,
                "peak": peak,
                "centres": [pose.centre for pose in now.values()],
                "lengths": [pose.mesh.length for pose in now.values()],
                "metrics": [measure(filtered[k], coefficients, pose) for pose in now.values()],
            }
    return results
