"""Every size of effect in the simulated cohort, each with its source or marked as a guess.

The parameters of the cohort were fixed before any estimator was run on it; a test holds their
checksum (:func:`checksum`). They may not be moved to make an estimator look better.
"""

from __future__ import annotations

import hashlib

from igrip.errors import UnknownNameError
from igrip.settings import Settings, quantity

PAPER = "paper, Sec. Experiment"


class ProtocolParameters(Settings):
    """What the participants do."""

    repetitions: int = quantity(4, "1", "of hand × object × grip × movement", PAPER, ge=1)
    rate: float = quantity(30.0, "Hz", "frames of the cameras", PAPER, gt=0)
    rest: float = quantity(1.0, "s", "rest before the movement, at least", "guess", ge=0)
    rest_spread: float = quantity(0.6, "s", "more rest, uniform up to this", "guess", ge=0)
    hold: float = quantity(0.6, "s", "recorded after the movement", "guess", ge=0)
    table_width: float = quantity(0.72, "m", "objects stand within it, left to right", "guess")
    table_near: float = quantity(0.26, "m", "nearest place of an object", "guess")
    table_far: float = quantity(0.56, "m", "furthest place of an object", "guess")
    separation: float = quantity(0.17, "m", "minimum distance of two objects", "guess")
    rest_aside: float = quantity(0.20, "m", "resting hands, from the middle", "guess")
    rest_height: float = quantity(0.04, "m", "palm over the table at rest", "guess")
    palm_to_body: float = quantity(0.045, "m", "palm to surface in a palmar grasp", "guess")
    palm_to_top: float = quantity(0.05, "m", "palm over the top in a pinch", "guess")
    simulated_short: float = quantity(
        0.015, "m", "a simulated grasp stops this much earlier, mean", "guess", ge=0
    )


class PersonParameters(Settings):
    """How people of one profile move: mean over people, and sd between and within people."""

    duration: float = quantity(
        1.37, "s", "of the whole minimum jerk; by the 10 % rule the mean movement lasts 1.19 s",
        "paper: 0.52 + 0.67 s",
    )  # fmt: skip
    duration_between: float = quantity(0.16, "s", "sd between people", "guess", ge=0)
    duration_within: float = quantity(0.12, "s", "sd between trials", "guess", ge=0)
    peak_time: float = quantity(
        0.45, "1", "part of the duration at peak speed (0.5: symmetric)",
        "Jeannerod 1984, J. Motor Behav. 16:235-254: grasping decelerates for longer",
    )  # fmt: skip
    peak_time_between: float = quantity(0.03, "1", "sd between people", "guess", ge=0)
    lift: float = quantity(0.05, "m", "height of the path over its chord", "guess", ge=0)
    lift_between: float = quantity(0.02, "m", "sd between people", "guess", ge=0)
    lift_within: float = quantity(0.012, "m", "sd between trials", "guess", ge=0)
    curvature: float = quantity(
        0.04, "1", "sideways bow over the chord, outwards",
        "Atkeson & Hollerbach 1985, J. Neurosci. 5:2318-2330: slightly curved",
    )  # fmt: skip
    curvature_within: float = quantity(0.03, "1", "sd between trials", "guess", ge=0)
    aim_error: float = quantity(
        0.025, "m", "sd of where the first submovement ends, each axis",
        "guess; Meyer et al. 1988, Psychol. Rev. 95:340-370: corrected late",
    )  # fmt: skip
    end_error: float = quantity(0.010, "m", "sd of where the hand stops, each axis", "guess")
    submovements: float = quantity(
        0.6, "1", "mean number of corrective submovements", "Meyer et al. 1988: often one"
    )
    undershoot: float = quantity(
        0.05, "1", "part of the way left to each corrective submovement but one", "guess", ge=0
    )
    tremor: float = quantity(
        0.0004, "m", "amplitude of physiological tremor",
        "guess; Elble & Koller 1990, Tremor: well below 1 mm",
    )  # fmt: skip
    tremor_frequency: float = quantity(9.0, "Hz", "its frequency", "Elble & Koller 1990: 8-12 Hz")
    sway: float = quantity(0.002, "m", "sd of the drift of a resting hand", "guess", ge=0)
    hesitation: float = quantity(0.04, "1", "probability of a stop on the way", "guess")
    hesitation_time: float = quantity(0.35, "s", "how long it lasts", "guess")
    change_of_mind: float = quantity(
        0.03, "1", "probability that the reach begins towards another object", "guess"
    )
    change_at: float = quantity(
        0.35, "1", "part of the duration at which it turns, mean",
        "Henis & Flash 1995, Biol. Cybern. 72:407-419: superposition",
    )  # fmt: skip


class CameraParameters(Settings):
    """Errors of a camera, and of the detection of hands and objects."""

    aside: float = quantity(0.45, "m", "camera from the middle, left or right", "guess")
    behind: float = quantity(0.10, "m", "camera behind the resting hands", PAPER + ": at shoulder")
    height: float = quantity(0.50, "m", "camera over the table", PAPER + ": shoulder level")
    placement: float = quantity(0.03, "m", "sd of its place between participants", "guess", ge=0)
    lateral_noise: float = quantity(0.002, "m", "sd across the line of sight", "guess", ge=0)
    disparity_noise: float = quantity(
        0.5, "px", "sd; depth: z² sd / (focal · baseline)", "guess; stereo geometry"
    )
    focal: float = quantity(800.0, "px", "focal length", "OAK-D S2 at 1280 px: about 800 px")
    baseline: float = quantity(0.075, "m", "between the lenses", "OAK-D S2 data sheet: 7.5 cm")
    correlation: float = quantity(0.6, "1", "of the noise from frame to frame", "guess", lt=1)
    outliers: float = quantity(0.003, "1", "probability a frame", "guess", ge=0)
    outlier_size: float = quantity(0.06, "m", "sd of an outlier along the line of sight", "guess")
    lost: float = quantity(0.0145, "1", "probability a frame that a hand begins to be lost", "57 %")
    lost_for: float = quantity(2.7, "frames", "mean length of such a burst", "57 % valid trials")
    moving_lost: float = quantity(3.0, "1", "times likelier at 1 m/s (motion blur)", "guess", ge=0)
    swapped: float = quantity(0.0015, "1", "probability a frame of swapped labels", "guess")
    duplicated: float = quantity(0.0015, "1", "probability that one hand gets both", "guess")
    object_rate: float = quantity(12.5, "Hz", "poses a second", "paper: 10-15 Hz", gt=0)
    object_latency: float = quantity(0.12, "s", "age of a pose on arrival", "guess", ge=0)
    object_bias: float = quantity(0.005, "m", "sd of a recording's offset, each axis", "guess")
    object_bias_turn: float = quantity(0.04, "rad", "sd of its turn, each axis", "guess")
    object_jitter: float = quantity(0.0015, "m", "sd from pose to pose, each axis", "guess")
    object_jitter_turn: float = quantity(0.015, "rad", "sd from pose to pose", "guess")
    flips: float = quantity(0.01, "1", "probability of a symmetric flip a pose", "guess")
    object_lost: float = quantity(0.012, "1", "probability that it begins to be lost", "57 %")
    object_lost_for: float = quantity(4.0, "poses", "mean length of such a burst", "57 %")
    never_found: float = quantity(0.03, "1", "probability that an object is never found", "57 %")
    arm_radius: float = quantity(0.05, "m", "of the forearm that occludes", "guess")
    occluded: float = quantity(0.5, "1", "probability of a loss behind the arm", "guess")


class CohortParameters(Settings):
    """The parameters of one cohort."""

    profile: str = "healthy"
    protocol: ProtocolParameters = ProtocolParameters()
    person: PersonParameters = PersonParameters()
    camera: CameraParameters = CameraParameters()


PROFILES: dict[str, PersonParameters] = {
    "healthy": PersonParameters(),
    "stroke": PersonParameters(
        duration=1.37 + 0.20, duration_between=0.30, duration_within=0.20, peak_time=0.38,
        curvature=0.17, curvature_within=0.09, aim_error=0.050, end_error=0.014,
        submovements=2.5, undershoot=0.30, tremor=0.0010, sway=0.003, hesitation=0.10,
    ),
    "sci": PersonParameters(
        duration=1.37 + 0.25, duration_between=0.25, duration_within=0.16, peak_time=0.40,
        lift=0.075, curvature=0.07, curvature_within=0.05, aim_error=0.035, end_error=0.012,
        submovements=2.2, undershoot=0.12, tremor=0.0007, sway=0.003, hesitation=0.07,
    ),
}  # fmt: skip
"""The people of each profile.

Stroke, aimed at: movement time +2.6 sd, peak speed -1.8 sd and path ratio +0.8 sd of the healthy
(sizes as reported for reaching after stroke), with several submovements (Rohrer et al. 2002, J.
Neurosci. 22:8297-8304). Reached, over people and trials together: +2.7, -0.8 (-1.4 by medians) and
+0.4 sd: our healthy reaches differ in length, hence in peak speed, more than those of a clinical
task. Spinal cord injury (C5-C7, reach without finger function): slower, a lower peak and more lift;
sizes are guesses.
"""


def cohort_parameters(profile: str = "healthy") -> CohortParameters:
    """Return the parameters of a profile.

    Raises
    ------
    UnknownNameError
        If there is no such profile.
    """
    if profile not in PROFILES:
        raise UnknownNameError("profile", profile, PROFILES)
    return CohortParameters(profile=profile, person=PROFILES[profile])


def checksum(parameters: CohortParameters) -> str:
    """Return a digest of every parameter."""
    return hashlib.sha256(parameters.model_dump_json().encode()).hexdigest()[:16]
