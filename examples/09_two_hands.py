"""Both hands reach at once, each for a different object; each has its own intention."""

import sys

import matplotlib.pyplot as plt

import igrip

estimator = igrip.Estimator(igrip.load_objects("ycb"))
upright = [0, 0, 0, 1]
objects = {
    "mustard": {"model": "006_mustard_bottle", "position": [-0.2, 0.4, 0], "orientation": upright},
    "soup": {"model": "005_tomato_soup_can", "position": [0.25, 0.3, 0], "orientation": upright},
}
starts = {"left": [-0.25, 0.0, 0.05], "right": [0.2, 0.0, 0.05]}
ends = {"left": [-0.2, 0.33, 0.1], "right": [0.25, 0.23, 0.07]}

probability = {hand: [] for hand in starts}
for frame in range(46):
    done = max(0.0, (frame - 15) / 30)
    done = 10 * done**3 - 15 * done**4 + 6 * done**5  # a minimum-jerk reach of one second
    hands = {
        hand: {"position": [a + done * (b - a) for a, b in zip(start, ends[hand], strict=True)]}
        for hand, start in starts.items()
    }
    observation = igrip.Observation(t=frame / 30, hands=hands, objects=objects)
    for intention in estimator.update(observation):
        probability[intention.hand].append((intention.t, intention.probability or {}))

figure, all_axes = plt.subplots(2, sharex=True, figsize=(6, 4), layout="constrained")
for axes, (hand, moments) in zip(all_axes, probability.items(), strict=True):
    for name, style in (("mustard", "-"), ("soup", "--"), ("none", ":")):
        values = [p.get(name, float("nan")) for _, p in moments]
        axes.plot([t for t, _ in moments], values, style, label=name)
    axes.set(ylabel="probability", ylim=(0, 1), title=f"{hand} hand")
    last = moments[-1][1]
    print(f"{hand} hand: {max(last, key=last.get)}")
all_axes[-1].set_xlabel("time [s]")
all_axes[0].legend(loc="upper left", fontsize="small")
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
