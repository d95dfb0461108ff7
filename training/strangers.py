"""The shipped estimator on sets that nothing was learned from: the exoskeleton first of all.

Example: python -m training.strangers shared
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from igrip.adaptation import Person
from igrip.commitment import CommitmentConfig, Committer
from igrip.evidence import Evidence
from igrip.lab.evaluation.calibration import ReliabilityBins
from igrip.targets.bayes import Bayes
from igrip.targets.learned.network import Scorer
from igrip.targets.learned.timing import default_timing
from training.arms import simulate_arm
from training.handovers import simulate_handovers
from training.hands_at_work import hands_at_work
from training.held_out import NAMES, held_out
from training.moments import Frames, Recording, follow
from training.sources import SEED
from training.timing import contact_time

PEOPLE = range(10_000, 10_020)  # of the generators, none of whom was learned from
PARTS = (0.4, 0.6)  # of the movement
WINDOW = 0.04  # of the movement, about each part


class Answered(NamedTuple):
    """A recording with its frames, and the evidence for a commitment in each."""

    recording: Recording
    frames: Frames
    evidence: list[Evidence]


def answer(recording: Recording, scorer: Scorer | None = None) -> Answered:
    """Return what an estimator makes of a recording: by default the one that ships."""
    posterior, frames, evidence = Bayes(scorer), follow(recording), []
    for motion, geometry in frames:
        estimate = posterior.update(motion, geometry, {})
        ids = [placed.id for placed in geometry.objects]
        x, y, z = motion.position.tolist()
        assert estimate.probability is not None
        one = Evidence(
            t=motion.t, measured=motion.t, position=(x, y, z), trusted=True,
            moving=motion.reach.moving,
            target=None if estimate.target is None else ids[estimate.target], grip="palmar",
            confidence=dict(zip(ids, estimate.probability.tolist(), strict=False)),
            trusted_objects=frozenset(ids),
            distances=dict(zip(ids, geometry.vertex.tolist(), strict=True)),
            familiarity=estimate.familiarity,
        )  # fmt: skip
        evidence.append(one)
    return Answered(recording, frames, evidence)


def reaches_row(answered: Sequence[Answered], config: CommitmentConfig) -> list[str]:
    """Return accuracy, calibration and first commitments on a set of reaches, as cells."""
    accurate: dict[float, list[bool]] = {part: [] for part in PARTS}
    stated, hits, parts, right = [], [], [], []
    for recording, _, evidence in answered:
        within = [e for e in evidence if e.t <= recording.end + 1e-9]
        for part in PARTS:
            until = recording.onset + part * (recording.end - recording.onset) + 1e-9
            newest = [e.target for e in within if e.t <= until][-1:]
            accurate[part].append(newest == [recording.target])
        for one in within:
            if one.target is not None:
                stated.append(one.confidence[one.target])
                hits.append(one.target == recording.target)
        committer = Committer(config)
        first = next((e for e in within if committer.update(e) is not None), None)
        if first is None:
            parts.append(math.nan)
        else:
            parts.append(max(0.0, (first.t - recording.onset) / (recording.end - recording.onset)))
            right.append(committer.target == recording.target)
    committed, mean_part = ~np.isnan(parts), np.nan_to_num(parts, nan=1.0)
    columns: tuple[Any, ...] = (*accurate.values(), committed, right, mean_part)
    share = [f"{100 * np.mean(column):.1f} %" for column in columns]
    error = ReliabilityBins.of(stated, hits).calibration_error()
    return [str(len(answered)), *share[:2], f"{error:.3f}", *share[2:]]


def timing_row(answered: Sequence[Answered]) -> list[str]:
    """Return error (median / 90 %) and coverage of the predicted time of contact, as cells."""
    errors: dict[float, list[float]] = {part: [] for part in PARTS}
    inside: dict[float, list[bool]] = {part: [] for part in PARTS}
    for recording, frames, _ in answered:
        contact = contact_time(recording, frames)
        for motion, geometry in frames if contact is not None else ():
            done = (motion.t - recording.onset) / (recording.end - recording.onset)
            near = [part for part in PARTS if abs(done - part) <= WINDOW]
            if not near or not motion.reach.may_move or contact is None or motion.t >= contact:
                continue
            ids = [placed.id for placed in geometry.objects]
            target = geometry.cylinders().one(ids.index(str(recording.target)))
            low, median, high = default_timing().predict(motion, target).contact
            errors[near[0]].append(abs(median - (contact - motion.t)))
            inside[near[0]].append(low <= contact - motion.t <= high)
    cells = []
    for part in PARTS:
        if len(errors[part]) < 10:
            cells += ["-", "-"]
            continue
        median, ninety = np.quantile(errors[part], [0.5, 0.9])
        cells += [f"{1000 * median:.0f} / {1000 * ninety:.0f} ms"]
        cells += [f"{100 * np.mean(inside[part]):.0f} %"]
    return cells


def adapted_row(answered: Sequence[Answered], config: CommitmentConfig) -> list[str]:
    """Return committed and right first commitments while the threshold follows each person.

    Their reaches come one after the other, and each ends with a rest at its target.
    """
    persons: dict[str, Person] = {}
    committed, right = [], []
    for recording, _, evidence in answered:
        committer = Committer(config, persons.setdefault(recording.person, Person()))
        within = [e for e in evidence if e.t <= recording.end + 1e-9]
        if not within or recording.target is None:
            continue
        first = None
        for one in within:
            if committer.update(one) is not None and first is None:
                first = committer.target
        for rest in (0.1, 0.2, 1.0):
            t = within[-1].t + rest
            near = dict.fromkeys(within[-1].distances, 1.0) | {recording.target: 0.0}
            committer.update(within[-1]._replace(t=t, measured=t, moving=False, distances=near))
        committed.append(first is not None)
        if first is not None:
            right.append(first == recording.target)
    return [f"{100 * np.mean(column):.1f} %" for column in (committed, right)]


def false_commitments(answered: Iterable[Answered], config: CommitmentConfig) -> float:
    """Return how many leases begin in a minute of recordings without a reach."""
    count, minutes = 0, 0.0
    for recording, _, evidence in answered:
        committer, newest = Committer(config), None
        for one in evidence:
            lease = committer.update(one)
            if lease is not None and (lease.target, lease.since) != newest:
                newest = lease.target, lease.since
                count += 1
        minutes += (recording.messages[-1].t - recording.messages[0].t) / 60.0
    return count / minutes


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        prog="python -m training.strangers", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("shared", type=Path, help="folder of the sets")
    shared = parser.parse_args().shared
    arms = [r for k in PEOPLE for r in simulate_arm(SEED, k)]
    sets = {name: list(held_out(shared, name)) for name in NAMES}
    sets["arms"] = [r for r in arms if r.target and not r.absent and math.isfinite(r.end)]
    met = [r for k in PEOPLE for r in simulate_handovers(SEED, k)]
    sets["handovers"] = [r for r in met if r.kind == "handover"]
    answered = {name: [answer(r) for r in recordings] for name, recordings in sets.items()}
    default = CommitmentConfig()
    flat = default.model_copy(update={"strange_margin": 0.0})
    print("| set | reaches | 40 % | 60 % | ECE | committed | right | part | without margin |")
    print(f"|{' --- |' * 9}")
    for name, one in answered.items():
        without = " / ".join(reaches_row(one, flat)[-3:])
        print(f"| {' | '.join([name, *reaches_row(one, default), without])} |", flush=True)
    print("\n| set | time to contact at 40 % | inside | at 60 % | inside |")
    print("| --- | --- | --- | --- | --- |")
    for name, one in answered.items():
        print(f"| {' | '.join([name, *timing_row(one)])} |", flush=True)
    print("\n| set | reliability | committed | right | with adaptation: committed | right |")
    print(f"|{' --- |' * 6}")
    for name, one in answered.items():
        for reliability in (0.2, 0.4, 0.6):
            config = CommitmentConfig(reliability=reliability)
            plain = reaches_row(one, config)[-3:-1]
            row = [name, str(reliability), *plain, *adapted_row(one, config)]
            print(f"| {' | '.join(row)} |", flush=True)
    work = [answer(r) for r in hands_at_work(shared / "hands_at_work", SEED, learned=False)]
    idle = [answer(r) for r in arms if r.target is None]
    carrying = [answer(r) for r in met if r.target is None]
    print("\n| without a reach | false commitments a minute | the same without margin |")
    print("| --- | --- | --- |")
    for name, recordings in (("hands at work", work), ("arms", idle), ("carrying", carrying)):
        rates = [f"{false_commitments(recordings, config):.2f}" for config in (default, flat)]
        print(f"| {name} | {' | '.join(rates)} |", flush=True)


if __name__ == "__main__":
    main()
