"""Options of pose estimators: from texts, and as settings; old names are pointed out."""

import pytest

from igrip.errors import IgripError
from igrip.perception.options import parse_options
from igrip.perception.poses import POSES


def test_options_are_words_or_json():
    options = parse_options(["tags=tags.toml", 'instances={"box": 2}', "seed=3"])
    assert options == {"tags": "tags.toml", "instances": {"box": 2}, "seed": "3"}
    for wrong in ("tags", "=x", "instances={"):
        with pytest.raises(IgripError):
            parse_options([wrong])


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("depth", "farthest", "max_depth"),
        ("tags", "missing", "missing_after"),
        ("cosypose", "least", "min_score"),
    ],
)
def test_the_error_for_an_old_name_gives_the_new_one(shapes, name, old, new):
    options = {old: 1.0, "tags": {7: {}}} if name == "tags" else {old: 1.0}
    with pytest.raises(IgripError, match=f"{name}: .*{old} was renamed to {new}"):
        POSES.get(name)(shapes, options)
