"""Configurations in files: TOML that tomllib reads, refused with the key at fault."""

import tomllib

import pytest

from igrip.config import Config
from igrip.errors import UnknownNameError
from igrip.io.config_file import ConfigFileError, changed_values, config_text, read_config

CONFIG = Config(
    targets="paper", commitment={"reliability": 0.57, "assisted": ("left",)},
    motion={"reach": {"time_constant": 0.08}},
)  # fmt: skip


def test_what_is_written_is_read(tmp_path):
    text = config_text(changed_values(CONFIG), {"targets": "why"}, ["anna", ""])
    assert tomllib.loads(text) == {
        "targets": "paper", "commitment": {"reliability": 0.57, "assisted": ["left"]},
        "motion": {"reach": {"time_constant": 0.08}},
    }  # fmt: skip
    assert text.startswith("# anna\n#\n")
    assert 'targets = "paper"  # why\n' in text
    path = tmp_path / "anna.toml"
    path.write_text(text, encoding="utf-8")
    assert read_config(path) == CONFIG


def test_the_default_changes_nothing(tmp_path):
    path = tmp_path / "empty.toml"
    path.write_text(config_text(changed_values(Config()), {}, ["nothing"]), encoding="utf-8")
    assert read_config(path) == Config()


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("[commitment]\nreliabilty = 0.5\n", "commitment: there is no 'reliabilty'.*reliability"),
        ("[commitment]\nreliability = 2.0\n", "commitment.reliability: .*less than or equal to 1"),
        ("[commitment]\nleast = 0.4\n", "least was renamed to min_threshold"),
        ("commitment = 1\n", "commitment: "),
        ("[commitment\n", "is not TOML"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, text, problem):
    path = tmp_path / "odd.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigFileError, match=problem) as caught:
        read_config(path)
    assert str(path) in str(caught.value)


def test_other_errors(tmp_path):
    with pytest.raises(ConfigFileError, match=r"no\.toml"):
        read_config(tmp_path / "no.toml")
    path = tmp_path / "odd.toml"
    path.write_text('targets = "bayse"\n', encoding="utf-8")
    with pytest.raises(UnknownNameError, match="bayes"):
        read_config(path)
