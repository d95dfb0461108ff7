"""A hand moves to one of two objects, and igrip estimates which."""

import sys

import igrip

catalog = igrip.load_objects("ycb")
estimator = igrip.Estimator(catalog, igrip.Config(targets="bayes"))

upright = [0, 0, 0, 1]
objects = {
    "mustard": {"model": "006_mustard_bottle", "position": [-0.1, 0.4, 0], "orientation": upright},
    "soup": {"model": "005_tomato_soup_can", "position": [0.3, 0.3, 0], "orientation": upright},
}
intentions = []
for frame in range(31):
    done = frame / 30
    done = 10 * done**3 - 15 * done**4 + 6 * done**5  # a minimum-jerk reach of one second
    hand = {"position": [0.2 - 0.22 * done, 0.35 * done, 0.05 + 0.04 * done]}
    observation = igrip.Observation(t=frame / 30, hands={"right": hand}, objects=objects)
    intentions += estimator.update(observation)

for intention in intentions[::5]:
    sure = f"{intention.confidence or 0.0:.0%}"
    print(f"{intention.t:.2f} s", intention.status, intention.target, sure, intention.grip)
if len(sys.argv) > 1:
    igrip.plot_probability(intentions, sys.argv[1])  # needs the extra "report"
