"""When a device may act: confidence, threshold and the lease, for three settings."""

import sys

import matplotlib.pyplot as plt

import igrip
from igrip.lab.simulation.demo import DemoPerson

catalog = igrip.load_objects("ycb")
figure, all_axes = plt.subplots(3, sharex=True, figsize=(7, 5), layout="constrained")
for axes, reliability in zip(all_axes, (0.2, 0.65, 0.95), strict=True):
    config = igrip.Config(commitment={"reliability": reliability})
    estimator = igrip.Estimator(catalog, config)
    person = DemoPerson(catalog, seed=0)
    task = next(person.tasks())
    times, confidences, leased = [], [], []
    for moment in person:
        if moment.observation.t > task.end + 0.3:
            break
        for intention in estimator.update(moment.observation):
            if intention.hand == task.hand:
                times.append(intention.t)
                confidences.append((intention.probability or {}).get(task.target, float("nan")))
                leased.append(intention.commitment is not None)
    axes.plot(times, confidences, label=f"probability of {task.target}")
    axes.axhline(config.commitment.threshold, linestyle="--", color="0.4", label="threshold")
    axes.fill_between(times, 0, 1, where=leased, hatch="//", alpha=0.2, label="lease")
    axes.axvline(task.end, linestyle=":", color="0.2", label="end of the movement")
    axes.set(ylabel="probability", ylim=(0, 1), title=f"reliability {reliability}")
    first = times[leased.index(True)] if any(leased) else None
    when = "no lease" if first is None else f"a lease {task.end - first:.2f} s before the end"
    print(f"reliability {reliability}: {when}")
all_axes[0].legend(loc="upper left", fontsize="small")
all_axes[-1].set_xlabel("time [s]")
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
