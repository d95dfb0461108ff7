"""Replay a recording and print what changes: ``python examples/02_replay.py reach.jsonl``."""

import sys

import igrip
from igrip.describe import describe


def main(path: str) -> None:
    estimator = igrip.Estimator(igrip.load_objects("ycb"))
    before: dict[str, str | None] = {}
    for observation in igrip.open_source(path):
        for intention in estimator.update(observation):
            if intention.target != before.get(intention.hand):
                before[intention.hand] = intention.target
                print(f"{intention.t:6.2f} s  {describe(intention)}")


if __name__ == "__main__":
    main(sys.argv[1])
