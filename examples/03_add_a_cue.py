"""A cue of one's own, and an estimator that uses it, in one file."""

import sys

import matplotlib.pyplot as plt
import numpy as np

import igrip
from igrip.cues import cue
from igrip.targets import TARGETS, TargetEstimate, best_of


@cue("heading", order=1)
def heading(motion, geometry, config):
    """Cosine between the velocity and the direction to each object's centre."""
    away = np.array([placed.centre for placed in geometry.objects]) - motion.position
    distance = np.maximum(np.linalg.norm(away, axis=1), 1e-9)  # the hand may be at the centre
    return away @ motion.velocity / (distance * max(motion.speed, 1e-9))


@TARGETS.register("my_heading")
class Heading:
    def update(self, motion, geometry, cues):
        return TargetEstimate(best_of(cues["heading"]), cues["heading"])


estimator = igrip.Estimator(
    igrip.load_objects("box:0.05x0.05x0.2"), igrip.Config(targets="my_heading")
)
box = {"model": "box:0.05x0.05x0.2", "orientation": [0, 0, 0, 1]}
objects = {"ahead": {**box, "position": [0.5, 0, 0]}, "aside": {**box, "position": [0, 0.5, 0]}}
times, scores = [], []
for frame in range(31):
    turn = np.pi / 2 * frame / 30  # a quarter of a circle: first ahead, then aside
    hands = {"right": {"position": [0.3 * np.sin(turn), 0.3 * (1 - np.cos(turn)), 0]}}
    observation = igrip.Observation(t=frame / 30, hands=hands, objects=objects)
    for intention in estimator.update(observation):
        if intention.status == "reaching":
            times.append(intention.t)
            scores.append([intention.scores[name]["heading"] for name in objects])
        if frame % 10 == 0:
            print(f"{intention.t:.2f} s", intention.status, intention.target)

figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
for line, name, style in zip(np.transpose(scores), objects, ("-", "--"), strict=True):
    axes.plot(times, line, style, label=name)
axes.set(xlabel="time [s]", ylabel="heading: cosine", title="a cue of one's own")
axes.legend()
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
