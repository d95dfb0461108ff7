"""Replay a recording, print what changes and draw it: ``02_replay.py [PICTURE [RECORDING]]``."""

import sys
import tempfile
from itertools import islice
from pathlib import Path

import igrip
from igrip.describe import describe
from igrip.io.recordings.jsonl import JsonlWriter
from igrip.lab.simulation.demo import DemoPerson


def record_demo() -> Path:
    """Record 3 s of a simulated person."""
    path = Path(tempfile.mkdtemp()) / "reach.jsonl"
    with JsonlWriter(path) as file:
        for moment in islice(DemoPerson(igrip.load_objects("ycb")), 90):
            file.write(moment.observation)
    return path


def main(picture: str | None, recording: str | Path) -> None:
    estimator = igrip.Estimator(igrip.load_objects("ycb"))
    intentions = []
    before: dict[str, tuple[str, str | None]] = {}
    for observation in igrip.open_source(recording):
        for intention in estimator.update(observation):
            intentions.append(intention)
            state = (intention.status, intention.target)
            if state != before.get(intention.hand):
                before[intention.hand] = state
                print(f"{intention.t:6.2f} s  {describe(intention)}")
    if picture:
        igrip.plot_probability(intentions, picture)


if __name__ == "__main__":
    main(sys.argv[1] if sys.argv[1:] else None, sys.argv[2] if sys.argv[2:] else record_demo())
