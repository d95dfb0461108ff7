"""A configuration in a file: TOML, with the keys of ``docs/configuration.md``."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from igrip.config import Config
from igrip.errors import IgripError
from igrip.io.text import TextError, read_text


class ConfigFileError(IgripError, ValueError):
    """A file is no configuration; the message names the file and the key."""


def read_config(path: Path) -> Config:
    """Read a configuration; what the file does not name has its default.

    Raises
    ------
    ConfigFileError
        If it cannot be read, or a key is unknown or its value out of bounds.
    UnknownNameError
        If it names a targets estimator or grip selector that does not exist.
    """
    try:
        return Config(**tomllib.loads(read_text(path)))
    except TextError as error:
        raise ConfigFileError(str(error)) from error
    except OSError as error:
        raise ConfigFileError(f"{path}: {error.strerror or error}") from error
    except tomllib.TOMLDecodeError as error:
        raise ConfigFileError(f"{path}: is not TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        problem = first["msg"].removeprefix("Value error, ")
        raise ConfigFileError(f"{path}: {where + ': ' if where else ''}{problem}") from error


def config_text(values: Mapping[str, Any], notes: Mapping[str, str], head: Iterable[str]) -> str:
    """Return a file of a configuration.

    Parameters
    ----------
    values : mapping of str to value
        Numbers, texts, booleans and lists of these, by their keys (``commitment.reliability``).
    notes : mapping of str to str
        What stands behind a value, by key.
    head : iterable of str
        What stands above them, a line each.
    """
    tables: dict[str, list[str]] = {}
    for key, value in values.items():
        table, _, name = key.rpartition(".")
        line = f"{name} = {_toml(value)}"
        tables.setdefault(table, []).append(f"{line}  # {notes[key]}" if key in notes else line)
    lines = [f"# {line}".rstrip() for line in head]
    for table in sorted(tables):  # those of no table come first, as TOML demands
        lines += ["", f"[{table}]", *tables[table]] if table else tables[table]
    return "\n".join(lines) + "\n"


def flat_values(values: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """Return the values of nested tables by their whole keys."""
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, Mapping):
            flat |= flat_values(value, f"{path}{name}.")
        else:
            flat[f"{path}{name}"] = value
    return flat


def changed_values(config: Config) -> dict[str, Any]:
    """Return what differs from the defaults, by key."""
    default = flat_values(Config().model_dump())
    return {
        key: value for key, value in flat_values(config.model_dump()).items()
        if value != default[key]
    }  # fmt: skip


def _toml(value: Any) -> str:
    """Return a value as TOML, which writes texts, numbers, booleans and lists as JSON does."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
