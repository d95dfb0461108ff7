"""C3D files, beside an independent reader and writer."""

from __future__ import annotations

import struct

import numpy as np
import pytest

import mocap_files as mocap
from igrip.errors import DatasetError
from igrip.io.takes.c3d import is_c3d, read_c3d
from igrip.io.takes.declared import Declared
from mocap_files import Body, Scene

N = 30
COURSE = np.cumsum(np.random.default_rng(2).normal(0, 0.004, (N, 3)), axis=0) + 0.4
COURSE[8:11] = np.nan
SEEN = np.isfinite(COURSE[:, 0])


def assert_is_the_course(path, tolerance=1e-6, name="RHand", **declared):
    take = read_c3d("take", path, Declared(**declared))
    track = take.tracks[name]
    np.testing.assert_allclose(track.positions, COURSE[SEEN], atol=tolerance)
    np.testing.assert_allclose(track.times, np.flatnonzero(SEEN) / 120.0, atol=1e-6)
    assert take.gaps[name] == 3
    return take


def scene(names=("RHand", "mug")) -> Scene:
    return Scene(np.arange(N) / 120, {name: Body(COURSE) for name in names}, 120.0)


@pytest.mark.parametrize("unit", ["mm", "m"])
def test_floats(tmp_path, unit):
    assert_is_the_course(mocap.c3d(tmp_path / "t.c3d", scene(), unit))


def test_files_of_an_independent_writer(tmp_path):
    ezc3d = pytest.importorskip("ezc3d", reason="a package of the tests is not installed")
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [120.0]
    file["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    names = [f"M{k}" for k in range(300)] + ["RHand"]  # more than 255: LABELS2
    file["parameters"]["POINT"]["LABELS"]["value"] = names
    points = np.zeros((4, len(names), N))
    points[:3, :, :] = 7.0
    points[3] = 1.0
    points[:3, -1, :] = 1000.0 * COURSE.T
    file["data"]["points"] = points
    file["parameters"]["ANALOG"]["RATE"]["value"] = [240.0]
    file["parameters"]["ANALOG"]["LABELS"]["value"] = ["force"]
    file["data"]["analogs"] = np.random.default_rng(0).normal(size=(1, 1, 2 * N))
    file.write(str(tmp_path / "t.c3d"))
    take = assert_is_the_course(tmp_path / "t.c3d")
    assert len(take.tracks) == 301


def test_an_independent_reader_agrees(tmp_path):
    ezc3d = pytest.importorskip("ezc3d", reason="a package of the tests is not installed")
    path = mocap.c3d(tmp_path / "t.c3d", scene())
    theirs = ezc3d.c3d(str(path))["data"]["points"][:3, 0].T
    ours = read_c3d("t", path, Declared()).tracks["RHand"].positions
    np.testing.assert_allclose(ours, theirs[SEEN] / 1000.0, atol=1e-9)


def rewritten(path, order, kind, convert):
    """Return a float file with its numbers in the form of another processor."""
    data = bytearray(path.read_bytes())
    for at, form in ((2, "HHHHH"), (12, "f"), (16, "HH"), (20, "f")):
        _put(data, at, form, order, convert)
    offset = 512 + 4
    data[512 + 3] = kind
    while data[offset]:
        end = offset + 2 + data[offset]
        step = struct.unpack_from("<H", data, end)[0]
        number = struct.unpack_from("b", data, offset + 1)[0]
        if number > 0:
            form = {2: "H", 4: "f"}.get(struct.unpack_from("b", data, end + 2)[0])
            if form:
                _put(data, end + 4 + data[end + 3], form, order, convert)
        _put(data, end, "H", order, convert)
        offset = end + step
    floats = np.frombuffer(bytes(data[2048:]), "<f4")
    data[2048:] = b"".join(convert(float(value)) for value in floats)
    path.write_bytes(bytes(data))
    return path


def _put(data, at, form, order, convert):
    values = struct.unpack_from("<" + form, data, at)
    if form == "f":
        data[at : at + 4] = convert(values[0])
    else:
        struct.pack_into(order + form, data, at, *values)


def dec(value: float) -> bytes:
    words = struct.unpack("<2H", struct.pack("<f", value * 4.0))
    return struct.pack("<2H", words[1], words[0])


@pytest.mark.parametrize(
    ("order", "kind", "convert"), [(">", 86, lambda v: struct.pack(">f", v)), ("<", 85, dec)]
)
def test_numbers_of_other_processors(tmp_path, order, kind, convert):
    path = rewritten(mocap.c3d(tmp_path / "t.c3d", scene()), order, kind, convert)
    assert_is_the_course(path)


def test_integers(tmp_path):
    path = mocap.c3d(tmp_path / "t.c3d", scene())
    data = bytearray(path.read_bytes())
    struct.pack_into("<f", data, 12, 0.1)
    numbers = np.frombuffer(bytes(data[2048:]), "<f4").reshape(-1, 4)
    rows = np.column_stack([np.round(numbers[:, :3] / 0.1), numbers[:, 3]]).astype("<i2")
    path.write_bytes(bytes(data[:2048]) + rows.tobytes())
    assert_is_the_course(path, tolerance=1e-4)


def test_what_is_left_out_and_renamed(tmp_path):
    take = read_c3d(
        "t", mocap.c3d(tmp_path / "t.c3d", scene(("*12", "A:RHand", "B:RHand"))), Declared()
    )
    assert set(take.tracks) == {"RHand", "RHand'"}


@pytest.mark.parametrize("length", [0, 1, 3, 500, 515, 900, 2100])
def test_files_that_are_cut(tmp_path, length):
    path = mocap.c3d(tmp_path / "t.c3d", scene())
    path.write_bytes(path.read_bytes()[:length])
    with pytest.raises(DatasetError, match=r"t\.c3d"):
        read_c3d("t", path, Declared())


def test_what_is_c3d(tmp_path):
    assert is_c3d(mocap.c3d(tmp_path / "t.dat", scene()))
    (tmp_path / "t.csv").write_text("Pa,b")
    assert not is_c3d(tmp_path / "t.csv")
    assert not is_c3d(tmp_path / "none")
