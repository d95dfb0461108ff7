"""A cue of one's own, and an estimator that uses it, in one file."""

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
for frame in range(10):
    hands = {"right": {"position": [0.01 * frame, 0, 0]}}
    intentions = estimator.update(igrip.Observation(t=frame / 30, hands=hands, objects=objects))
print(intentions[0].target, intentions[0].scores["ahead"])
