"""Options in the names of cameras."""

import pytest

from igrip.errors import CameraError
from igrip.perception.cameras._options import split_options


def test_options():
    defaults = {"size": (1, 2), "fps": 30.0, "loop": False, "file": ""}
    assert split_options("a?size=640x400&fps=15&loop=1&file=b%20c+d=e", defaults) == (
        "a", {"size": (640, 400), "fps": 15.0, "loop": True, "file": "b c+d=e"},
    )  # fmt: skip
    assert split_options("", defaults) == ("", defaults)
    for wrong in (
        "?speed=1",
        "?fps=fast",
        "?fps=nan",
        "?fps=-1",
        "?size=3",
        "?size=0x2",
        "?loop=2",
    ):
        with pytest.raises(CameraError):
            split_options(wrong, defaults)
