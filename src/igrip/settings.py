"""Declarations of the numbers a user may change: default, unit, meaning and source together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from igrip.errors import did_you_mean

RENAMED: Mapping[str, Mapping[str, str]] = {
    "Config": {"health": "gating", "world": "tracking"},
    "TrackingConfig": {"most_hands": "max_hands", "most_objects": "max_objects"},
    "GatingConfig": {
        "hand_limit": "max_hand_age", "object_limit": "max_object_age",
        "hands_apart": "min_hand_separation", "objects_apart": "min_object_separation",
        "range_limit": "max_range",
    },
    "ReachConfig": {
        "leave": "onset_distance", "leave_noise": "onset_noise_factor",
        "leave_sway": "onset_sway_factor", "most_sway": "max_onset_sway",
        "max_sway": "max_onset_sway", "noise": "initial_noise",
        "rest_memory": "rest_time_constant", "calm": "end_time_constant",
        "rest_fraction": "rest_speed_fraction", "rest_noise": "rest_noise_factor",
        "dwell": "min_rest_duration", "longest_gap": "max_gap",
    },
    "ObjectConfig": {"still_speed": "rest_speed"},
    "RayConfig": {"rays": "rays_per_cone", "least_speed": "min_speed"},
    "CueConfig": {"least_speed": "min_speed", "single_spread": "default_spread"},
    "GripConfig": {"pinch_from": "pinch_threshold"},
    "CommitmentConfig": {
        "least": "min_threshold", "most": "max_threshold", "longest_dwell": "max_dwell",
        "lease": "lease_duration", "resume": "max_pause", "rest": "veto_rest_duration",
        "reach": "holding_distance", "leave": "release_margin",
    },
    "DepthOptions": {
        "misfit": "max_misfit", "nearest": "min_depth", "farthest": "max_depth",
        "every": "search_interval", "base": "tolerance",
    },
    "TagsOptions": {"lasting": "max_pose_age", "missing": "missing_after"},
    "CosyPoseOptions": {"least": "min_score", "patience": "timeout", "missing": "missing_after"},
    "MediaPipeConfig": {
        "hands": "max_hands", "detection": "min_detection", "presence": "min_presence",
        "views": "tiles", "every": "search_every",
    },
    "PalmConfig": {
        "pixels": "min_pixels", "share": "min_share", "smallest": "min_length",
        "largest": "max_length", "grain": "correlation", "least": "min_std",
    },
    "CalibrationConfig": {
        "views": "max_views", "tags": "min_tags", "worst": "max_error", "still": "max_motion",
        "doubt": "min_ratio",
    },
    "LayoutConfig": {"apart": "min_gap"},
    "StereoNoise": {"nearest": "min_depth", "farthest": "max_depth", "grazing": "min_cosine"},
}  # fmt: skip
"""Keys of earlier versions by class: an old one raises an error that names the new one."""


class Settings(BaseModel):
    """Base of every module's configuration: frozen, and a misspelt name is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, values: Any) -> Any:
        """Name the key that was meant, and all that there are."""
        renamed = RENAMED.get(cls.__name__, {})
        for key in values if isinstance(values, Mapping) else ():
            if key in cls.model_fields or not isinstance(key, str):
                continue
            if key in renamed:
                raise ValueError(f"{key} was renamed to {renamed[key]}")
            near, names = did_you_mean(key, cls.model_fields), ", ".join(cls.model_fields)
            raise ValueError(f"there is no {key!r:.80}{near}; there are: {names}")
        return values


def problem_of(error: ValidationError) -> str:
    """Return the first problem of settings, with its place, as in ``reach.noise: must be …``."""
    first = error.errors()[0]
    place = ".".join(map(str, first["loc"]))
    return ": ".join(filter(None, (place, first["msg"].removeprefix("Value error, "))))


def quantity(default: Any, unit: str, meaning: str, source: str = "", **bounds: Any) -> Any:
    """Declare a number of a :class:`Settings` class.

    Parameters
    ----------
    default
        The value used unless the user sets another.
    unit
        Its unit, ``"1"`` for a pure number.
    meaning
        What it does, in one sentence.
    source
        Where the default comes from: a paper, a measurement or ``"guess"``.
    **bounds
        ``gt``, ``ge``, ``lt``, ``le`` as pydantic knows them.
    """
    return Field(
        default,
        description=f"{meaning} [{unit}]",
        json_schema_extra={"unit": unit, "source": source},
        **bounds,
    )
