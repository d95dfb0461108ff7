"""One trial by a map of columns: its row of the table of trials, and its take."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.cells.values import known_text, number
from igrip.io.column_map import ColumnMap
from igrip.io.column_names import near_miss
from igrip.io.hand_ids import match_hand, side_of
from igrip.io.mapped_takes import TRIAL_HAND, find_body, find_take, hand_tracks, trial_id
from igrip.io.plausibility import Finding, Samples, check_samples, refusal
from igrip.io.recorded_reach import MovingObject, RecordedReach
from igrip.io.takes.declared import Declared
from igrip.io.takes.jumps import jump_remark
from igrip.io.takes.roles import hands_of
from igrip.io.takes.take import Take, Track
from igrip.io.takes.upright import with_upright_axes

Array = NDArray[np.float64]


class TrialReader:
    """Reads the reach of one row of the table of trials, or of one take.

    Parameters
    ----------
    columns, declared : ColumnMap, Declared
        The map, and all that is declared.
    number : int
        Of the trial.
    line : int or None
        Of its row; None without a table of trials.
    row : mapping of str to str
        The cells by column.
    takes : mapping of str to Take or DatasetError
        By trial.
    take : str or None
        The trial, where no row names it.
    """

    def __init__(
        self,
        columns: ColumnMap,
        declared: Declared,
        number: int,
        line: int | None,
        row: Mapping[str, str],
        takes: Mapping[str, Take | DatasetError],
        take: str | None,
    ) -> None:
        self._map, self._declared, self._number = columns, declared, number
        self._row, self._takes, self._take = row, takes, take
        self._where = (
            f"take {take!r}" if line is None else f"table {columns.trials.table!r}, line {line}"
        )

    def __call__(self) -> RecordedReach:
        """Return the reach.

        Raises
        ------
        DatasetError
            If it cannot be used; the message names the row and the column.
        """
        want = self._map.trials
        trial = self._take if self._take is not None else trial_id(self._required(want.trial))
        key = self.take_name()
        if key is None:
            raise DatasetError(
                f"{self._where}: trial {trial!r} has no samples{near_miss(trial, self._takes)}"
            )
        take = self._takes[key]
        if isinstance(take, DatasetError):
            raise take
        hands = self._hands(take)
        hand, key = self._hand(take, hands)
        track = take.tracks[key]
        if not len(track.times):
            raise DatasetError(
                f"{self._where}: trial {trial!r}: hand {hand!r} was not seen in any of "
                f"{len(take.times)} samples, so its times do not increase"
            )
        moving = self._moving(take)
        several = len(take.tracks) > 1
        begin = 0.0 if several else float(track.times[0])
        placed = {
            id: self._position(id, take) for id, o in self._map.objects.items() if o.body is None
        }
        remarks = [*take.remarks, *self._check(take, hand, track, moving, placed)]
        return RecordedReach(
            name=re.sub(r"[^\w-]", "_", f"{self._number}_{trial}"),
            participant=self._cell(want.participant, "unknown") or "unknown",
            trial=trial,
            hand=hand,
            target=self._target(),
            times=track.times - begin,
            positions=track.positions,
            object_positions=placed,
            models={id: o.model for id, o in self._map.objects.items() if o.model},
            grip=self._grip(),
            movement=self._cell(want.movement),
            movement_only=False,
            moving_objects=moving,
            other_hands={id: take.tracks[k] for id, k in hands.items() if k != key and id != hand},
            onset_s=self._number_of(want.onset_s),
            end_s=self._number_of(want.end_s),
            lost=track.lost - begin,
            duration=float(take.times[-1]) if several else None,
            remarks=remarks,
            converted_from=None if take.frame.is_default else take.frame.to_dict(),
        )

    def take_name(self) -> str | None:
        """Return which of the takes is meant; None: none of them."""
        if self._take is not None:
            return self._take
        want = self._map.trials
        trial, participant = (self._row.get(name, "") for name in (want.trial, want.participant))
        return find_take(trial_id(trial), known_text(participant), self._takes)

    def _check(
        self,
        take: Take,
        hand: str,
        track: Track,
        moving: Mapping[str, MovingObject],
        placed: Mapping[str, Array],
    ) -> list[str]:
        """Return what is unusual; raise an error where a unit cannot be right."""
        objects = {id: _samples(moved.track) for id, moved in moving.items()}
        times = track.times  # an object that is placed is there all the time
        objects |= {
            id: Samples(times, np.tile(position, (len(times), 1)))
            for id, position in placed.items()
        }
        findings = check_samples(
            {hand: _samples(track)}, objects, take.frame.length_unit, take.frame.time_unit
        )
        problem = refusal(findings)
        if problem is not None:
            raise DatasetError(f"{self._where}: {problem}{_remedy(findings)}")
        remarks = [finding.text for finding in findings]
        jump = jump_remark(track)
        return [*remarks, jump] if jump else remarks

    def _hands(self, take: Take) -> dict[str, str]:
        """Return the tracks of all hands by id."""
        if self._map.hands:
            return hand_tracks(take, dict(self._map.hands))
        if TRIAL_HAND in take.tracks or self._map.samples.columns is not None:
            return {}
        used = {o.body for o in self._map.objects.values()}
        return {id: key for id, key in hands_of(take).items() if key not in used}

    def _hand(self, take: Take, hands: Mapping[str, str]) -> tuple[str, str]:
        """Return the id of the trial's hand and its track."""
        default = next(iter(hands)) if len(hands) == 1 else None
        if self._take is not None and not self._map.trials.hand.startswith("="):
            named = default
        else:
            named = self._cell(self._map.trials.hand, default)
        if named is None:
            choices = ", ".join(hands) or "none"
            raise DatasetError(
                f'{self._where}: its hand is not known; declare [trials] hand = "=right" or a '
                f"column (hands of the take: {choices})"
            )
        if TRIAL_HAND in take.tracks:
            return side_of(named) or named, TRIAL_HAND
        id = match_hand(named, list(hands))
        if id is None:
            bodies = ", ".join(key for key in take.tracks if not key.startswith(TRIAL_HAND))
            raise DatasetError(
                f"{self._where}: hand {named!r} is none of {', '.join(hands) or 'no known hand'}; "
                f'name its body: [hands.{side_of(named) or "right"}] body = "…" '
                f"(bodies: {bodies})"
            )
        return id, hands[id]

    def _target(self) -> str | None:
        want = self._map.trials.target
        if self._take is not None and not want.startswith("="):
            return None
        return self._required(want)

    def _moving(self, take: Take) -> dict[str, MovingObject]:
        found = {}
        for id, thing in self._map.objects.items():
            if thing.body is not None:
                track = take.tracks[find_body(thing.body, take)]
                if thing.pivot == "middle":
                    track = with_upright_axes(track, take.frame)
                found[id] = MovingObject(track, thing.pivot)
        return found

    def _position(self, id: str, take: Take) -> Array:
        thing = self._map.objects[id]
        numbers = []
        for axis in (thing.x, thing.y, thing.z):
            if isinstance(axis, float):
                numbers.append(axis)
                continue
            text = self._required(str(axis))
            value = number(text, "," if "," in text else ".", self._declared.missing)
            if value is None or value != value:
                raise DatasetError(f"{self._where}, column {axis!r}: {text!r} is no number")
            numbers.append(value)
        unit = self._declared.length_unit or take.frame.length_unit
        frame = (Declared(length_unit=unit) | self._declared).frame()
        return np.asarray(frame.positions(np.array(numbers)))

    def _cell(self, column: str | None, default: str | None = None) -> str | None:
        if column is None:
            return default
        if column.startswith("="):
            return column[1:]
        if self._take is not None:
            return default
        if column not in self._row:
            raise DatasetError(
                f"{self._where}: no column {column!r}{near_miss(column, self._row)}; it has "
                f"{', '.join(self._row)}"
            )
        return known_text(self._row[column])

    def _required(self, column: str) -> str:
        text = self._cell(column)
        if text is None:
            raise DatasetError(f"{self._where}: {column!r} is empty")
        return text

    def _number_of(self, column: str | None) -> float | None:
        text = self._cell(column)
        if text is None:
            return None
        value = number(text, "," if "," in text else ".")
        if value is None:
            raise DatasetError(f"{self._where}, column {column!r}: {text!r} is no time")
        return None if value != value else value

    def _grip(self) -> str | None:
        text = self._cell(self._map.trials.grip)
        if text is not None and text.lower() not in ("palmar", "pinch"):
            raise DatasetError(f"{self._where}: grip {text!r} is neither palmar nor pinch")
        return None if text is None else text.lower()


def _remedy(findings: Iterable[Finding]) -> str:
    """Return what to declare against what is refused, in a map or on the command line."""
    names = {"length_unit": "unit", "time_unit": "time_unit", "up": "up"}
    fixes = {f.fix for f in findings if f.verdict == "refuse" and f.fix is not None}
    words = [
        f'{names[key]} = "{value}" in the map, or --{names[key].replace("_", "-")} {value}'
        for key, value in sorted(fixes)
        if key in names
    ]
    return f" Declare {'; '.join(words)}" if words else ""


def _samples(track: Track) -> Samples:
    return Samples(track.times, track.positions, track.orientations)
