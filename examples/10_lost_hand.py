"""The camera loses the hand in mid-reach: the lease ends, and begins again when it is back."""

import sys
from itertools import pairwise

import matplotlib.pyplot as plt

import igrip
from igrip.lab.simulation.demo import DemoPerson
from igrip.lab.simulation.faults import Fault, inject

catalog = igrip.load_objects("ycb")
person = DemoPerson(catalog, seed=0)
task = next(person.tasks())
lost_at = task.end - 0.15
messages = []
for moment in person:
    if moment.observation.t > task.end + 0.4:
        break
    messages.append(moment.observation)

figure, axes = plt.subplots(figsize=(7, 2.5), layout="constrained")
config = igrip.Config(commitment={"reliability": 0.4})
for row, (label, faults) in enumerate(
    {"hand lost for 0.25 s": [Fault("lose", at=lost_at, lasts=0.25)], "hand seen": []}.items()
):
    estimator = igrip.Estimator(catalog, config)
    ends = []
    for message in inject(messages, faults):
        for intention in estimator.update(message):
            if intention.hand == task.hand and intention.commitment is not None:
                ends.append((intention.t, intention.commitment.valid_until))
    for begin, end in ends:
        axes.barh(row, min(end, begin + 0.04) - begin, left=begin, height=0.5, color="tab:blue")
    axes.text(0.05, row + 0.32, label)
    longest = max(b - a for (a, _), (b, _) in pairwise(ends))
    print(f"{label}: longest time without a lease {longest:.2f} s")
axes.axvspan(lost_at, lost_at + 0.25, color="0.85", hatch="..", zorder=0, label="not seen")
axes.axvline(task.end, linestyle=":", color="0.2", label="end of the movement")
axes.set(xlabel="time [s]", yticks=[], ylim=(-0.5, 1.7), xlim=(0, None), title="leases")
axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
