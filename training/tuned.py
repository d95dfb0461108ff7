"""Tuning judged on reaches that it has not seen: splits of each person's reaches.

Nothing was learned from the sets: an arm in an exoskeleton, and, with the tables of the near/far
reaches, the people who are kept back. One line for each set and number of reaches tuned on.

Example: python -m training.tuned shared --splits 4
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from igrip.config import Config
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.lab.tuning.front import point
from igrip.lab.tuning.outcomes import Outcomes, outcome
from igrip.lab.tuning.replays import Replays
from igrip.lab.tuning.search import silence
from igrip.lab.tuning.space import SPACE, first_candidates, with_values
from igrip.lab.tuning.tuning import MAX_LOSS, Tuning
from igrip.objects.catalog import load_objects
from training.held_out import held_out
from training.moments import Recording
from training.people import KEPT_BACK, real_recordings, record

EACH = 40  # reaches of each of the people who are kept back
PEOPLE = 6


def replays_of(recordings: Sequence[Recording], folder: Path) -> Replays:
    """Return reaches as the evaluation replays them."""
    models = {
        pose.model for one in recordings for message in one.messages
        for pose in message.objects.values() if pose is not None and pose.model is not None
    }  # fmt: skip
    sources = ["ycb", *sorted(model for model in models if ":" in model)]
    with DatasetWriter(folder, folder.name, "", "", objects=sources) as writer:
        for number, one in enumerate(recordings):
            trial = Trial(
                f"{number:04d}", one.person, hand=one.hand, target=one.target,
                onset_s=one.onset, end_s=one.end,
            )  # fmt: skip
            writer.add(trial, one.messages)
        dataset: Dataset = writer.close()
    return Replays(dataset, load_objects(*sources), Config(), dataset.trials)


def judge(replays: Replays, count: int, seed: int, candidates: int) -> np.ndarray | None:
    """Return what tuning on ``count`` reaches does on the others, beside the default.

    Whether it tuned; committed, right (of all) and wrong by default and tuned. None: there are too
    few reaches.
    """
    order = np.random.default_rng(seed).permutation(len(replays.usable))
    seen, unseen = order[:count], order[count:]
    if len(seen) < count or not len(unseen):
        return None

    def outcomes(values: Mapping[str, float], trials: Sequence[int]) -> Outcomes:
        config, known = with_values(Config(), values).commitment, replays.replayed(values)
        return Outcomes.of([outcome(known[k], config) for k in trials])

    tuning = Tuning(
        partial(outcomes, trials=seen.tolist()), [str(k) for k in seen], SPACE,
        first_candidates(Config()), seed=seed, limit=candidates,
    )  # fmt: skip
    for _ in tuning.run():
        pass
    decision = tuning.decide()
    row = [float(decision.tuned)]
    for values in (first_candidates(Config())[0], decision.values):
        one = point(values, outcomes(values, unseen.tolist()), 0.0)
        row += [one.committed, one.committed * (one.right or 0.0), one.wrong, one.part]
    return np.array(row)


def line(name: str, count: int, rows: np.ndarray) -> str:
    """Return a line of the table."""
    tuned, *mean = rows.mean(axis=0)
    cells = [name, str(count), str(len(rows)), f"{100.0 * tuned:.0f} %"]
    for committed, right, _, part in (mean[:4], mean[4:]):
        share = right / committed if committed else 0.0
        cells += [f"{100.0 * committed:.1f} / {100.0 * share:.1f} / {100.0 * part:.1f} %"]
    more_wrong = rows[:, 7] - rows[:, 3] > MAX_LOSS
    fewer_right = rows[:, 2] - rows[:, 6] > MAX_LOSS
    cells += [f"{100.0 * np.mean(one):.0f} %" for one in (more_wrong, fewer_right)]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m training.tuned", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("shared", type=Path, help="folder of the sets")
    parser.add_argument("--splits", type=int, default=4, help="of each person's reaches")
    parser.add_argument("--candidates", type=int, default=60, help="of each search")
    parser.add_argument("--people", type=int, default=PEOPLE, help="of near/far")
    options = parser.parse_args()
    silence()
    people: dict[str, list[Recording]] = {}
    for reach, seed in real_recordings(options.shared / "wispinski2021", 0, (KEPT_BACK,)):
        if reach.participant in people or len(people) < options.people:
            own = people.setdefault(reach.participant, [])
            recording = record(reach, seed)
            if len(own) < EACH and recording.target is not None:
                own.append(recording)
    sets = {"exo_plane": [list(held_out(options.shared, "exo_plane"))]}
    sets["near/far"] = list(people.values())
    print("| set | tuned on | splits | tuned | default: committed / right / part | tuned | more "
          f"wrong | fewer right |\n|{' --- |' * 8}")  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        for name, groups in sets.items():
            replays = [
                replays_of(one, Path(folder) / f"{name.replace('/', '-')}{k}")
                for k, one in enumerate(groups)
            ]
            for count in (16, 30, 50):
                rows = [
                    judge(one, count, seed, options.candidates)
                    for one in replays for seed in range(options.splits)
                ]  # fmt: skip
                known = [row for row in rows if row is not None]
                if known:
                    print(line(name, count, np.array(known)), flush=True)


if __name__ == "__main__":
    main()
