"""People made up for the tests of tuning: evidence for commitments, and what is right for them."""

import numpy as np

from igrip.config import Config
from igrip.evidence import Evidence
from igrip.lab.evaluation.commitments import MessageEvidence
from igrip.lab.tuning.outcomes import Outcomes, Replay, outcome
from igrip.lab.tuning.space import SPACE, is_upstream, values_of, with_values

RATE, SECONDS = 20, 2.0
UNSURE = 0.75  # the threshold of the default is 0.788
QUICK_SPACE = [p for p in SPACE if not is_upstream(p.key)]
PRESENT = values_of(Config(), QUICK_SPACE)


def reach(number, course, target="cup", participant="p"):
    """Return a reach of two seconds; ``course`` gives object and probability at its parts."""
    messages = []
    for k in range(int(RATE * SECONDS) + 1):
        t = k / RATE
        id, p = course(t / SECONDS)
        other = {"cup": "can", "can": "cup"}[id]
        evidence = Evidence(
            t=t, measured=t, position=(0.0, 0.0, 0.0), trusted=True, moving=True, target=id,
            grip="palmar", confidence={id: p, other: (1.0 - p) / 2, "none": (1.0 - p) / 2},
            trusted_objects={"cup", "can"}, distances={"cup": 0.4, "can": 0.4}, familiarity=1.0,
        )  # fmt: skip
        messages.append(MessageEvidence({"right": evidence}, frozenset()))
    return Replay(
        f"r{number}", participant, "right", target, (0.0, SECONDS), SECONDS, tuple(messages)
    )


def unsure(count, seed=0):
    """Return a person of whom the estimator is never sure, and always right."""
    random = np.random.default_rng(seed)
    starts = random.uniform(0.2, 0.4, count)
    return [
        reach(k, lambda part, s=s: ("cup", 0.3 if part < s else UNSURE))
        for k, s in enumerate(starts)
    ]


def misleading(count, seed=0):
    """Return a person for whom the default is right.

    Just below its threshold is the wrong object, just above it the right one; and for just less
    than its dwell the wrong one is above it.
    """
    random = np.random.default_rng(seed)

    def course(part, start):
        if part * SECONDS * RATE < start - 3.5:
            return "can", 0.77
        return ("can", 0.9) if part * SECONDS * RATE < start - 0.5 else ("cup", 0.8)

    starts = random.integers(16, 20, count)
    return [reach(k, lambda part, s=s: course(part, s)) for k, s in enumerate(starts)]


def work_out(replays):
    """Return the function that a tuning asks for outcomes."""

    def outcomes(values):
        config = with_values(Config(), values).commitment
        return Outcomes.of([outcome(one, config) for one in replays])

    return outcomes
