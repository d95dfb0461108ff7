"""Colours are told apart with every colour vision and on paper; letters come back."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path

import numpy as np
import pytest

from igrip.viewer import palette
from igrip.viewer.palette import INK, OBJECTS, PAPER, Looks, colour_of, letter_of, rgb

# Machado, Oliveira & Fernandes (2009), severity 1.0: linear red, green, blue as seen
VISIONS = {
    "normal": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                   [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                     [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                   [0.004733, 0.691367, 0.303900]],
}  # fmt: skip
STATIC = Path(palette.__file__).parent / "static"


def linear(colour):
    c = np.array(rgb(colour)) / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def lab(c):
    """CIE L*a*b* of linear sRGB, D65."""
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    ratio = (xyz @ np.clip(c, 0, 1)) / [0.9505, 1.0, 1.089]
    f = np.where(ratio > 0.008856, np.cbrt(ratio), 7.787 * ratio + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def contrast(a, b):
    """WCAG 2.2, relative luminance."""
    one, other = (linear(c) @ [0.2126, 0.7152, 0.0722] for c in (a, b))
    return (max(one, other) + 0.05) / (min(one, other) + 0.05)


@pytest.mark.parametrize("vision", VISIONS)
def test_the_first_four_colours_are_told_apart(vision):
    """More objects than that are told apart by their letters and dashes."""
    seen = [lab(np.array(VISIONS[vision]) @ linear(colour)) for colour in OBJECTS[:4]]
    for a, b in itertools.combinations(seen, 2):
        assert np.linalg.norm(a - b) > 20  # about ten times what is just noticed


@pytest.mark.parametrize("colour", OBJECTS)
def test_each_colour_stands_out_from_the_page_and_from_the_ink(colour):
    assert contrast(colour, PAPER) >= 3.0  # WCAG 1.4.11, graphics
    assert colour != INK


def test_ink_can_be_read_on_paper():
    assert contrast(INK, PAPER) >= 7.0


def test_the_page_has_the_same_colours():
    text = (STATIC / "looks.js").read_text(encoding="utf-8")
    assert tuple(json.loads(re.search(r"COLOURS = (\[.*?\])", text)[1])) == OBJECTS
    assert re.search(r'INK = "(.*?)"', text)[1] == INK


def test_letters_never_repeat():
    letters = [letter_of(k) for k in range(200)]
    assert letters[0] == "A"
    assert letters[26] == "A1"
    assert len(set(letters)) == 200
    assert colour_of(0) == colour_of(len(OBJECTS))


def test_an_object_keeps_its_number_and_gives_it_back_when_it_is_gone():
    looks = Looks()
    assert looks.update(["soup", "mustard"], 0.0)
    assert looks.numbers() == {"mustard": 0, "soup": 1}
    assert not looks.update(["soup"], 1.0)  # mustard is hidden for a moment
    assert looks.update(["soup", "bleach"], 2.0)
    assert looks.numbers() == {"mustard": 0, "soup": 1, "bleach": 2}
    assert looks.update(["bleach"], 11.5)
    assert looks.numbers() == {"bleach": 2, "soup": 1}
    for k in range(1000):  # a tracker that numbers its objects anew
        looks.update([f"object {k}"], 20.0 + k)
    assert len(looks.numbers()) <= 11
    assert max(looks.numbers().values()) <= 11
