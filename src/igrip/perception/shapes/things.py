"""The things before one camera: found, followed, refined, recognised and given up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from igrip.perception.registration.fit import PoseFit, refit
from igrip.perception.registration.hand_motion import HandMotion, Holders, MovingHand
from igrip.perception.registration.rigid_pose import RigidPose
from igrip.perception.registration.shape import derive_shape
from igrip.perception.registration.table import Table
from igrip.perception.registration.track import ANNEALING, DepthTrack
from igrip.perception.registration.view import DepthView, depth_view
from igrip.perception.shapes.depth_average import DepthAverage
from igrip.perception.shapes.fit_primitive import ShapeFit
from igrip.perception.shapes.join import fitted_segments
from igrip.perception.shapes.memory import Memory, Remembered
from igrip.perception.shapes.names import ThingName
from igrip.perception.shapes.options import ShapesOptions
from igrip.perception.shapes.segments import Segment, find_segments
from igrip.perception.shapes.thing import (
    Built,
    Thing,
    belongs_to,
    build_thing,
    fit_of,
    model_of,
    new_thing,
    shares_place,
    with_model,
)
from igrip.perception.transforms import inverse
from igrip.rgbd import Array, RgbdFrame

STILL = 0.015  # m; what moved less between two looks stood still
YOUNG = 1.0  # s; a thing so young that a hand turns out to be on was the hand
CUT_FACTOR = 3.0  # times as long as others must things stand that the picture's edge cuts
MAX_UNSURE = 1.0  # s; what neither agrees nor is confirmed by a segment for so long is not there
LOOKS = (0.15, 0.5, 1.5)  # s after it was first seen, at which a thing's model is made anew
UNCOVERED = 0.15  # share of a thing, which was hidden when its model was made and is not now
MIN_AGREEMENT = 0.6  # of a remembered thing with the picture, to be recognised
TURNS = 8  # about the vertical in which a remembered thing is tried


class _Pending(NamedTuple):
    """Something new, before it counts."""

    middle: Array  # (3,), frame of the table [m]
    since: float  # s


class Things:
    """What one camera sees that stands on the table.

    Attributes
    ----------
    table : Table
        Before the camera.
    followed : dict of str to Thing
        By id.
    gone : set of str
        Ids of what was there and is not.
    """

    def __init__(
        self, memory: Memory, names: Sequence[ThingName], options: ShapesOptions,
        random: np.random.Generator,
    ) -> None:  # fmt: skip
        self.table = Table()
        self.followed: dict[str, Thing] = {}
        self.gone: set[str] = set()
        self._memory, self._names, self._options = memory, names, options
        self._random = random
        self._average = DepthAverage()
        self._hands, self._holders = HandMotion(), Holders()
        self._pending: list[_Pending] = []
        self._searched: float | None = None
        self._reach = (options.min_depth, options.max_depth)

    def update(self, frame: RgbdFrame, hands: Sequence[Array], known: Sequence[PoseFit]) -> None:
        """Take a frame; see :meth:`igrip.perception.poses.shapes.ShapesPoses.estimate`."""
        seen = any(thing.track.state == "visible" for thing in self.followed.values())
        if not self.table.update(frame, self._reach, self._random, seen):
            return
        assert self.table.plane is not None
        if self.table.change is not None:
            self._carry_on(self.table.change)
        self._average.add(frame, self.table.plane.noise)
        view = depth_view(frame, hands, self.table.plane, self._options.tolerance)
        table_from_world = inverse(self.table.world_from_table)
        fits = [replace(fit, pose=fit.pose.after(table_from_world)) for fit in known]
        self._follow(view.beside_hands(), frame.t, self._hands.update(view, hands, frame.t))
        self._give_up(view, frame.t, fits)
        elapsed = np.inf if self._searched is None else frame.t - self._searched
        if not 0.0 <= elapsed < self._options.search_interval:
            self._search(view, frame, fits)
            self._searched = frame.t
        else:
            self._refine(view, frame, fits)

    def _carry_on(self, change: Array) -> None:
        """Move things into the frame of a table that was found anew."""
        for id, thing in self.followed.items():
            fit = replace(thing.track.fit, pose=thing.track.fit.pose.after(change))
            self.followed[id] = replace(thing, track=replace(thing.track, fit=fit))
        self._pending, self._searched = [], None

    def _follow(self, view: DepthView, t: float, hands: Sequence[MovingHand]) -> None:
        for id, thing in list(self.followed.items()):
            before = thing.track
            hand = self._holders.hand_at(id, before.fit, before.state == "visible", hands)
            track = before.update(view, t, hand)
            if track.state == "gone":
                self._drop(id)
                continue
            self.followed[id] = replace(thing, track=track)
            if track.state == "visible":
                self._memory.saw(id, self._in_world(track.fit.centre), t)

    def _give_up(self, view: DepthView, t: float, known: Sequence[PoseFit]) -> None:
        """Give up things that turn out to be a known object, or a hand."""
        for id, thing in list(self.followed.items()):
            fit = thing.track.fit
            lost = _is_unsure(thing) and t - thing.track.t > MAX_UNSURE
            if lost or any(shares_place(fit, other) for other in known):
                self._drop(id)
            elif t - thing.born < YOUNG and _under_hand(fit, view):
                self._drop(id)
                self._memory.forget(id)

    def _drop(self, id: str) -> None:
        del self.followed[id]
        self.gone.add(id)

    def _search(self, view: DepthView, frame: RgbdFrame, known: Sequence[PoseFit]) -> None:
        """Look for new things."""
        first = self._searched is None
        unsure = [id for id, thing in self.followed.items() if _is_unsure(thing)]
        fits = [*known, *(t.track.fit for id, t in self.followed.items() if id not in unsure)]
        segments = find_segments(self._average.depth, view, self._reach, fits)
        for id in unsure:
            segments = self._confirmed(id, segments, frame.t)
        pending, steady = [], []
        for segment in segments:
            if segment.touched:
                continue
            since = min(
                (one.since for one in self._pending
                 if np.linalg.norm(one.middle - segment.middle) < STILL), default=frame.t,
            )  # fmt: skip
            pending.append(_Pending(segment.middle, since))
            wait = self._options.steady * (CUT_FACTOR if segment.cut else 1.0)
            if frame.t - since >= wait or (first and not segment.cut):
                steady.append(segment)
        self._pending = pending
        for segment, shape in fitted_segments(steady, self._average.depth, view):
            if shape.misfit <= self._options.max_misfit:
                others = [*known, *(thing.track.fit for thing in self.followed.values())]
                self._add(segment, shape, view, frame, others)

    def _confirmed(self, id: str, segments: list[Segment], t: float) -> list[Segment]:
        """Hold a thing for visible if something stands where it is; return the other segments.

        A mesh that was made from one side may agree badly with what is seen from another.
        """
        track = self.followed[id].track
        own = [
            segment for segment in segments
            if belongs_to(segment, track.fit) > 0.5 and not segment.touched
        ]  # fmt: skip
        if own:
            seen = replace(track, t=t, state="visible", gone_for=0)
            self.followed[id] = replace(self.followed[id], track=seen)
        return [segment for segment in segments if not any(segment is one for one in own)]

    def _add(
        self, segment: Segment, shape: ShapeFit, view: DepthView, frame: RgbdFrame,
        fits: Sequence[PoseFit],
    ) -> None:  # fmt: skip
        """Begin to follow a thing: one that is remembered, or a new one."""
        built = build_thing(segment, shape, self._average.depth, frame.colour, view)
        middle = self._in_world(segment.middle)
        for id in self._memory.candidates(built.look, middle, frame.t, self.followed):
            fit = self._recognised(self._memory[id], segment, view)
            if fit is not None:
                track = DepthTrack(fit, frame.t, fit.hidden)
                self.followed[id] = Thing(
                    track, built.fit.kind, -np.inf, frame.t, fit.hidden, built.fit.std
                )
                break
        else:
            model = model_of("new", built)
            thing = new_thing(derive_shape(model), built, view, frame.t)
            if any(shares_place(thing.track.fit, other) for other in fits):
                return  # what a simple shape explains badly falls into pieces
            id = self._memory.new_id(built.look, self._names)
            model = replace(model, name=id)
            mesh = thing.track.fit.shape._replace(name=id)
            fit = replace(thing.track.fit, shape=mesh)
            self.followed[id] = replace(thing, track=replace(thing.track, fit=fit))
            self._memory.put(id, Remembered(model, mesh, built.look, middle, frame.t))
        self.gone.discard(id)

    def _recognised(self, thing: Remembered, segment: Segment, view: DepthView) -> PoseFit | None:
        """Return a remembered thing where a segment is; None: it does not fit."""
        points = segment.points
        depths = points @ view.camera_from_table[2, :3] + view.camera_from_table[2, 3]
        bottom = thing.shape.surface.points[:, 2].min()
        fits = []
        for angle in np.linspace(0.0, 2.0 * np.pi, TURNS, endpoint=False):
            c, s = np.cos(angle), np.sin(angle)
            turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            at = turn @ thing.shape.surface.centre
            shift = np.append(segment.footprint.middle - at[:2], -bottom)
            start = fit_of(thing.shape, RigidPose(turn, shift), view, 0.0)
            fits.append(refit(start, points, depths, view, ANNEALING))
        best = max(fits, key=lambda fit: fit.score)
        good = best.agreement >= MIN_AGREEMENT and best.cover >= MIN_AGREEMENT
        return best if good else None

    def _refine(self, view: DepthView, frame: RgbdFrame, known: Sequence[PoseFit]) -> None:
        """Make the model of one thing anew, if it is time to; keep it if it changes enough."""
        due = next((id for id in self.followed if self._is_due(id, frame.t)), None)
        if due is None:
            return
        thing = self.followed[due]
        fit = thing.track.fit
        self.followed[due] = replace(
            thing, built=frame.t, hidden=min(thing.hidden, thing.track.fit.hidden)
        )
        others = [*known, *(other.track.fit for id, other in self.followed.items() if id != due)]
        own = [
            segment for segment in find_segments(self._average.depth, view, self._reach, others)
            if belongs_to(segment, fit) > 0.5
        ]  # fmt: skip
        if not own or any(segment.touched for segment in own):
            return
        # what kind it is was decided when its picture was averaged for a while
        kinds = (thing.kind,) if thing.built - thing.born > LOOKS[0] else None
        segment, shape = fitted_segments(own, self._average.depth, view, kinds)[0]
        built = build_thing(segment, shape, self._average.depth, frame.colour, view)
        if not self._differs(built, due, fit):
            return
        model = model_of(due, built, fit.pose)
        self.followed[due] = replace(
            with_model(self.followed[due], model, view, frame.t), kind=shape.kind
        )
        mesh = self.followed[due].track.fit.shape
        middle = self._in_world(segment.middle)
        self._memory.put(due, Remembered(model, mesh, built.look, middle, frame.t))

    def _is_due(self, id: str, t: float) -> bool:
        thing = self.followed[id]
        track = thing.track
        if track.state != "visible" or np.linalg.norm(track.velocity) > STILL:
            return False
        age, before = t - thing.born, thing.built - thing.born
        if age <= self._options.refine_until and any(before < look <= age for look in LOOKS):
            return True
        return track.fit.hidden < thing.hidden - UNCOVERED

    def _differs(self, built: Built, id: str, fit: PoseFit) -> bool:
        """Whether a view's size or middle is another than the model's, by the declared step."""
        step = self._options.refine_step
        before = self._memory[id].look.size
        if (np.abs(built.look.size - before) > step * before).any():
            return True
        low, high = built.mesh.bounds
        middle = 0.5 * (low + high) + built.origin
        return bool(np.linalg.norm(middle - fit.centre) > step * before[0])

    def _in_world(self, point: Array) -> Array:
        world = self.table.world_from_table
        return np.asarray(world[:3, :3] @ point + world[:3, 3])


def _is_unsure(thing: Thing) -> bool:
    """Whether a thing does not agree with the picture although little covers it."""
    share = thing.track.fit.visibility
    open_share = 1.0 - share.hidden - share.outside - share.missing
    return thing.track.state == "hidden" and open_share > 0.5


def _under_hand(fit: PoseFit, view: DepthView) -> bool:
    """Whether a hand is where a thing is in the picture, not only before a part of it."""
    points = fit.pose.apply(fit.shape.surface.points)
    points = points @ view.camera_from_table[:3, :3].T + view.camera_from_table[:3, 3]
    pixels = np.round(view.intrinsics.pixels(points)).astype(int)
    height, width = view.mask.shape
    inside = ((pixels >= 0) & (pixels < (width, height))).all(axis=1)
    pixels = pixels[inside]
    return bool(len(pixels) and (view.mask[pixels[:, 1], pixels[:, 0]] > 0).mean() > 0.5)
