"""Probability of each object and of none during a simulated reach."""

import sys

import matplotlib.pyplot as plt

import igrip
from igrip.lab.simulation.demo import DemoPerson

catalog = igrip.load_objects("ycb")
estimator = igrip.Estimator(catalog)
person = DemoPerson(catalog, seed=0)
task = next(person.tasks())

times, probabilities = [], []
for moment in person:
    if moment.observation.t > task.end:
        break
    for intention in estimator.update(moment.observation):
        if intention.hand == task.hand and intention.probability is not None:
            times.append(intention.t)
            probabilities.append(intention.probability)

figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
for name in probabilities[-1]:
    style = ":" if name == "none" else "-"
    values = [probability.get(name, float("nan")) for probability in probabilities]
    axes.plot(times, values, style, label=name)
axes.axvspan(task.onset, task.end, color="0.9", label="movement")
axes.set(xlabel="time [s]", ylabel="probability", ylim=(0, 1), title=f"reach for {task.target}")
axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
print(f"at the end: {task.target} with probability {probabilities[-1][task.target]:.2f}")
