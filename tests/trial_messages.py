"""One trial and its messages, written down by hand: for the tests of the evaluation."""

from igrip import Observation
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.recorded_trial import RecordedTrial

TRIAL = Trial(
    "r", participant="p", camera_side="left", hand="right", target="cup", grip="pinch",
    movement="executed", onset_s=0.2, end_s=1.0,
)  # fmt: skip
POSE = {"model": "m", "position": [0, 0.4, 0], "orientation": [0, 0, 0, 1]}


def record(hand, cup, trial=TRIAL):
    """Return messages at 10 Hz: x detected, . looked for and not detected, else not looked for."""
    recorded = RecordedTrial(trial)
    for k, (h, c) in enumerate(zip(hand, cup, strict=True)):
        hands = {"right": {"position": [0, 0.01 * k, 0]} if h == "x" else None}
        objects = {} if c == " " else {"cup": POSE if c == "x" else None}
        recorded.add(Observation(t=k / 10, hands=hands, objects=objects))
    return recorded
