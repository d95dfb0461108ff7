"""A thing is turned before the rendered camera; its scan is held against its true surface."""

import numpy as np
import pytest
import trimesh

from benchmarks.measure_scan import found_again, judged, scanned, thing
from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.catalog import load_objects
from igrip.objects.model import build_model
from igrip.perception.cameras._turned_thing import EYE, TurnedThing, standing
from igrip.perception.scan.catalogue_entry import Scan, write_entry
from igrip.perception.scan.find import NO_TABLE, NOTHING
from igrip.perception.scan.options import ScanOptions
from igrip.perception.scan.scanner import UNTURNED, ScanError, Scanner
from igrip.perception.transforms import inverse
from rgbd_frames import frame as plain_frame

CAMERA = look_at(EYE, np.array([0.0, 0.0, 0.06]))
BOX = build_model("plain box", trimesh.creation.box((0.12, 0.05, 0.09)))
CAN = build_model("plain can", trimesh.creation.cylinder(0.034, 0.1, sections=64))
MM = 1e-3


def stills(count, *placed, every=0.1, start=0.0):
    scene = RenderedScene({str(k): one for k, one in enumerate(placed)}, CAMERA)
    random = np.random.default_rng(0)
    for k in range(count):
        yield scene.frame(start + every * k, random)


def gather(scanner, frames):
    return sum(scanner.add(frame) for frame in frames)


def at(model, yaw=0.4, x=0.0, y=0.0):
    return PlacedMesh(model, standing(model, yaw, np.array([x, y])))


class Brief(TurnedThing):
    """A film in which the thing stands somewhere else after each pause; no hand is in it."""

    def film(self, begin=0.0):
        for k, pose in enumerate(self.poses):
            scene = RenderedScene({"thing": PlacedMesh(self._model, pose)}, CAMERA)
            for j in range(6):
                yield scene.frame(begin + 3.0 * k + 0.1 * j, self._random)


def check(name, tmp_path, film, round_thing=False, median=1.0, most=3.0, size=0.05):
    """Scan a thing, compare it with the truth, and find it again elsewhere."""
    model = film._model
    scanner, mesh = scanned(film, round_thing)
    world_from_mesh = scanner.first_pose()
    result = judged(mesh, model, film.poses[0], world_from_mesh)
    assert mesh.is_volume
    assert len(mesh.faces) < 40_000
    assert mesh.bounds[0, 2] == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(mesh.bounds.mean(axis=0)[:2], 0.0, atol=1e-9)
    assert np.median(result.to_true) < median * MM
    assert np.percentile(result.to_true, 95) < most * MM
    np.testing.assert_allclose(result.size, 1.0, atol=size)
    write_entry(tmp_path, f"my_{name}", Scan(mesh, scanner.picture(), round_thing, {}))
    mesh_from_model = inverse(world_from_mesh) @ film.poses[0]
    away = found_again(load_objects(tmp_path), f"my_{name}", model, mesh_from_model)
    assert away < 5 * MM


@pytest.mark.timeout(1200)
def test_a_box_is_scanned_and_found_again(tmp_path):
    # its thinnest edge comes out 2.8 mm too long in docs/scan.md: more than 5 % of 50 mm
    check("box", tmp_path, Brief(BOX, step=42.0), size=0.065)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_bottle_is_scanned_and_found_again(tmp_path):
    check("bottle", tmp_path, TurnedThing(thing("bottle")))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_mug_is_scanned_and_found_again(tmp_path):
    # its floor is seen by no view from 40°, and is filled
    check("mug", tmp_path, TurnedThing(thing("mug")), most=20.0)


def test_a_round_thing_needs_one_view():
    scanner = Scanner(ScanOptions(), round_thing=True)
    for frame in stills(8, at(CAN)):
        if scanner.add(frame):
            break
    assert scanner.done
    mesh = scanner.mesh()
    sizes = np.sort(mesh.extents)
    np.testing.assert_allclose(sizes, [0.068, 0.068, 0.1], rtol=0.05)
    gap = abs(np.linalg.norm(mesh.vertices[:, :2], axis=1) - 0.034)
    side = (mesh.vertices[:, 2] > 0.01) & (mesh.vertices[:, 2] < 0.09)
    assert np.median(gap[side]) < 1.5 * MM


def test_what_is_not_round_is_not_scanned_as_if_it_were():
    scanner = Scanner(ScanOptions(), round_thing=True)
    gather(scanner, stills(8, at(BOX)))
    with pytest.raises(ScanError, match="without --round"):
        scanner.mesh()


@pytest.mark.parametrize(
    ("placed", "words"),
    [([], NOTHING), ([at(BOX, x=-0.1), at(CAN, x=0.1)], "2 things stand on the table: leave")],
)
def test_what_is_wrong_is_told_with_the_way_out(placed, words):
    scanner = Scanner(ScanOptions(patience=1.0))
    with pytest.raises(ScanError, match=f"nothing new for 1 s: {words}"):
        gather(scanner, stills(20, *placed, every=0.2))
    with pytest.raises(ScanError, match=words):
        scanner.mesh()


def test_a_thing_that_is_not_turned_is_told_to_be():
    scanner = Scanner(ScanOptions())
    assert gather(scanner, stills(12, at(BOX))) == 1
    assert scanner.problem == UNTURNED
    assert scanner.degrees == 60.0
    with pytest.raises(ScanError, match="turn it on, by about 30 degrees"):
        scanner.mesh()


def test_a_part_of_a_turn_is_too_little():
    scanner = Scanner(ScanOptions())
    for k in range(3):
        gather(scanner, stills(6, at(BOX, 0.4 + k * np.radians(30.0)), start=3.0 * k))
    assert len(scanner.views) == 3
    assert scanner.degrees == pytest.approx(120.0, abs=3.0)
    with pytest.raises(ScanError, match=r"only 1[12][0-9] of 360 degrees were seen: turn it on"):
        scanner.mesh()


def test_without_depth_or_table_it_says_so():
    with pytest.raises(ScanError, match="needs a camera with depth"):
        Scanner(ScanOptions()).add(plain_frame(depth=False))
    scanner = Scanner(ScanOptions())
    empty = plain_frame()
    empty.depth[:] = 0.0
    assert not scanner.add(empty)
    assert scanner.problem == NO_TABLE
