"""The cues of the paper, one pure function a file, and the family they belong to."""

from igrip.cues.base import CUES, Cue, CueConfig, cue

__all__ = ["CUES", "Cue", "CueConfig", "cue"]
