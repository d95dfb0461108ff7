"""Tiny hand-made files with the layouts of public sets; the numbers are made up."""

import csv
import json

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.lab.simulation.minimum_jerk import reach

RATE = 30.0
FRAMES = 75  # 0.5 s of rest, 1 s of reaching, 1 s of lifting
START, PLACE = np.array([0.0, -0.3, 0.05]), np.array([0.10, 0.2, 0.06])
OTHER = np.array([-0.2, 0.2, 0.06])


def movement():
    """Return palms (n, 3) and places of the taken object (n, 3), on a table, z up."""
    parts = np.clip((np.arange(FRAMES) / RATE - 0.5), 0.0, 1.0)
    hand = reach(START, PLACE - [0.0, 0.05, 0.0], 0.05, parts)
    lift = np.clip(np.arange(FRAMES) / RATE - 1.5, 0.0, 1.0) * 0.2
    hand = hand + np.outer(lift, [0, 0, 1])
    return hand, PLACE + np.outer(lift, [0, 0, 1])


# the tag on the table, seen from the master camera, and one more camera
TAG = (Rotation.from_euler("xyz", [2.0, 0.3, 0.5]), np.array([0.1, -0.2, 0.9]))
SECOND = (Rotation.from_euler("xyz", [0.2, 0.4, -0.3]), np.array([0.4, 0.1, 0.0]))


def write_dexycb(folder, subject="20200709-subject-01", seen_from=20):
    """Write one sequence of DexYCB; the master camera sees the hand from a frame on."""
    sequence = folder / subject / "20200709_141754"
    serials = ["840412060917", "836212060125"]
    poses = {serials[0]: (Rotation.identity(), np.zeros(3)), serials[1]: SECOND, "apriltag": TAG}
    extrinsics = folder / "calibration" / "extrinsics_20200702_151821"
    extrinsics.mkdir(parents=True)
    lines = ["extrinsics:"]
    for name, (turn, place) in poses.items():
        numbers = np.hstack([turn.as_matrix(), place[:, None]]).ravel()
        key = f"'{name}'" if name.isdigit() else name
        lines += [f"  {key}:", *(f"  - {x!r}" for x in numbers.tolist())]
    (extrinsics / "extrinsics.yml").write_text("\n".join([*lines, f"master: '{serials[0]}'"]))
    hand, taken = movement()
    objects = np.stack([np.tile(OTHER, (FRAMES, 1)), taken], axis=1)
    turns = np.tile(TAG[0].as_quat(), (FRAMES, 2, 1))
    world = TAG[0].apply(objects.reshape(-1, 3)).reshape(objects.shape) + TAG[1]
    sequence.mkdir(parents=True)
    np.savez(sequence / "pose.npz", pose_y=np.concatenate([turns, world], axis=2),
             pose_m=np.zeros((FRAMES, 1, 51)))  # fmt: skip
    (sequence / "meta.yml").write_text(
        f"serials:\n- '{serials[0]}'\n- '{serials[1]}'\nnum_frames: {FRAMES}\n"
        "extrinsics: 20200702_151821\nycb_ids:\n- 2\n- 5\nycb_grasp_ind: 1\nmano_sides:\n- right\n"
        "mano_calib:\n- 20200709-subject-01_right\n"
    )
    for serial in serials:
        (sequence / serial).mkdir()
        turn, place = poses[serial]
        for k in range(FRAMES):
            palm = TAG[0].apply(hand[k]) + TAG[1]
            joints = np.tile(turn.inv().apply(palm - place), (21, 1))
            if serial == serials[0] and k < seen_from:
                joints = -np.ones((21, 3))
            np.savez(sequence / serial / f"labels_{k:06d}.npz", joint_3d=joints[None])
    return sequence


def write_hot3d(folder, name="P0001_10a27bf7"):
    """Write one sequence of HOT3D, and the names of its objects."""
    sequence = folder / name
    (sequence / "hand_data").mkdir(parents=True)
    hand, taken = movement()
    stamps = [10_000_000_000 + round(k * 1e9 / RATE) for k in range(FRAMES)]
    with (sequence / "dynamic_objects.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["object_uid", "timestamp[ns]", "t_wo_x[m]", "t_wo_y[m]", "t_wo_z[m]",
                       "q_wo_w", "q_wo_x", "q_wo_y", "q_wo_z"])  # fmt: skip
        for k, stamp in enumerate(stamps):
            rows.writerow(["111", stamp, *taken[k], 1, 0, 0, 0])
            rows.writerow(["222", stamp, *OTHER, 1, 0, 0, 0])
    with (sequence / "hand_data" / "umetrack_hand_pose_trajectory.jsonl").open("w") as file:
        for k, stamp in enumerate(stamps):
            wrist = {"q_wxyz": [1, 0, 0, 0], "t_xyz": hand[k].tolist()}
            far = {"q_wxyz": [1, 0, 0, 0], "t_xyz": [-0.6, -0.4, 0.1]}
            poses = {"0": {"wrist_xform": far, "joint_angles": []},
                     "1": {"wrist_xform": wrist, "joint_angles": []}}  # fmt: skip
            file.write(json.dumps({"timestamp_ns": stamp, "hand_poses": poses}) + "\n")
    (folder / "assets").mkdir(exist_ok=True)
    names = {"111": {"instance_name": "mug_white"}, "222": {"instance_name": "bowl"}}
    (folder / "assets" / "instance.json").write_text(json.dumps(names))
    return sequence


def write_grab(path, root_of, **changes):
    """Write one sequence of GRAB; ``root_of(palms)`` returns the translations of the right hand."""
    hand, taken = movement()
    still = {"transl": np.tile([-0.5, 0, 0.3], (FRAMES, 1)), "global_orient": np.zeros((FRAMES, 3))}
    right = {"transl": root_of(hand), "global_orient": np.zeros((FRAMES, 3))}
    held = {"transl": taken, "global_orient": np.zeros((FRAMES, 3))}
    path.parent.mkdir(parents=True, exist_ok=True)
    content = {
        "framerate": RATE, "obj_name": "mug", "sbj_id": "s1", "n_frames": FRAMES,
        "lhand": {"params": still, "vtemp": "x"}, "rhand": {"params": right, "vtemp": "x"},
        "object": {"params": held, "object_mesh": "x"},
    } | changes  # fmt: skip
    np.savez(path, **{key: np.array(value, dtype=object) if isinstance(value, dict) else value
                      for key, value in content.items()})  # fmt: skip
    return path
