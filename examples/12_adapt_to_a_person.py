"""The threshold of one person follows how often a lease was right."""

import sys

import matplotlib.pyplot as plt
import numpy as np

import igrip
from igrip.adaptation import Person
from igrip.lab.simulation.demo import DemoPerson

catalog = igrip.load_objects("ycb")
config = igrip.Config(commitment={"reliability": 0.65})
person = Person()  # igrip.io.person_file keeps it in a file
estimator = igrip.Estimator(catalog, config, person)
margins = [person.margin]
for moment in DemoPerson(catalog, seed=3):
    estimator.update(moment.observation)
    if person.reaches > len(margins) - 1:
        margins.append(person.margin)
    if person.reaches == 10 or moment.observation.t > 60:
        break

figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
threshold = config.commitment.threshold + np.array(margins)
axes.step(range(len(margins)), threshold, where="post")
axes.set(xlabel="reaches of this person", ylabel="confidence required for a lease",
         title=f"{person.wrong} of {person.reaches} leases were wrong")  # fmt: skip
figure.savefig(sys.argv[1]) if len(sys.argv) > 1 else plt.show()
print(f"{person.reaches} reaches, {person.wrong} wrong; threshold {threshold[-1]:.3f}")
