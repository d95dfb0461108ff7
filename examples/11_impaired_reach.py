"""Speed of the palm in simulated reaches: a healthy person and one after a stroke."""

import sys

import matplotlib.pyplot as plt
import numpy as np

from igrip.lab.simulation.movement import draw_habits, draw_reach
from igrip.lab.simulation.parameters import cohort_parameters

start, goal = np.array([0.2, 0.0, 0.05]), np.array([0.0, 0.4, 0.12])
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
for profile, style in (("healthy", "-"), ("stroke", "--")):
    random = np.random.default_rng(4)
    person = cohort_parameters(profile).person
    reach = draw_reach(person, draw_habits(person, random), start, goal, 0.2, None, random)
    times = np.arange(0.0, reach.end + 0.2, 0.005)
    speeds = np.linalg.norm(np.gradient(reach.position(times), 0.005, axis=0), axis=1)
    axes.plot(times, 1000 * speeds, style, label=profile)
    print(f"{profile}: {len(reach.submovements)} submovements, {reach.end - 0.2:.2f} s")
axes.set(xlabel="time [s]", ylabel="speed [mm/s]", title="one reach each")
axes.legend()
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
