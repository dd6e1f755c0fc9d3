"""Compares the paper's regressor, ours, and ours with one option changed, on the real clips.

Each regressor is trained on 60 frames of person_a_1 and follows all of person_a_2, also darkened,
lit from the side, partly covered, before other backgrounds, and at a fourth and an eighth of the
frame rate. Labels and reference are the generic aligner's, lifted to 3D, so distances are against
that network, not against truth.

Run: python -m tests.benchmarks.regressor_options [--seeds N] [option ...]
"""

import argparse
import sys
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2
import numpy as np

from app.resources import asset
from core.alignment import FaceAligner
from core.augmentation import AugmentationSettings, normal_maps
from core.camera import camera_for, project
from core.evaluation import frame_rmse_px, jitter, still_frames
from core.geometry import register_rigid
from core.landmarks import MESH478, N_INTERNAL, PUPILS478, SHAPE_TRIANGLES
from core.regressor import Regression, RegressionSettings
from core.regressor_trainer import PAPER_SETTINGS, TrainSettings, train
from core.training_set import TrainingSetSettings, make_training_set
from core.turned_views import TurnSettings
from tests.conftest import REPOSITORY
from tests.synthetic_face import finish

#: Points of the network near the 15 replacement points, and its face oval.
REPLACEMENTS478 = (69, 299, 139, 368, 142, 371, 117, 346, 207, 427, 214, 434, 211, 431, 199)
OVAL478 = (10, 338, 297, 332, 284, 251, 389, 356, 454, 323, 361, 288, 397, 365, 379, 378, 400, 377)
OVAL478 += (152, 148, 176, 149, 150, 136, 172, 58, 132, 93, 234, 127, 162, 21, 54, 103, 67, 109)
#: Points that expressions hardly move; their size gives the distance.
STEADY478 = (33, 133, 362, 263, 168, 6, 195, 4, 10, 127, 356, 234, 454)
STEADY_RADIUS_MM = 55.0
FOCAL_AT_640_PX = 600.0
#: A hand covers the mouth in these frames of person_a_1.
COVERED = range(1090, 1305)


@dataclass(frozen=True)
class Option:
    """What differs from the defaults, by the record of settings it belongs to."""

    samples: dict = field(default_factory=dict)
    light: dict = field(default_factory=dict)
    training: dict = field(default_factory=dict)
    points: dict = field(default_factory=dict)
    running: dict = field(default_factory=dict)
    base: TrainSettings = field(default_factory=TrainSettings)

    def settings(self):
        """Return the settings of the training set, of training and of running."""
        light = AugmentationSettings(**self.light)
        points = replace(self.base.points, **self.points)
        return (
            TrainingSetSettings(**self.samples, augmentation=light),
            replace(self.base, **self.training, points=points),
            RegressionSettings(**self.running),
        )


AS_TAKEN = TurnSettings(further_deg=())
NO_LIGHT = {"exposure": 0.0, "lamp_share": 0.0, "occluded_share": 0.0}
OPTIONS = {
    "paper": Option(
        samples={"same_pose": False, "turn_rad": 0.0, "turning": AS_TAKEN},
        light=NO_LIGHT,
        running={
            "same_pose": False,
            "use_median": True,
            "again_mm": 1e9,
            "keep_size": False,
        },
        base=PAPER_SETTINGS,
    ),
    "ours": Option(),
    "poses as in other pictures": Option(
        samples={"same_pose": False}, running={"same_pose": False}
    ),
    "pictures only as taken": Option(samples={"turning": AS_TAKEN}),
    "guesses not turned": Option(samples={"turn_rad": 0.0}),
    "offsets from one landmark": Option(points={"barycentric": False}),
    "points near landmarks": Option(points={"spread": 0.15}),
    "200 points": Option(points={"n_points": 200}),
    "smaller cells": Option(points={"cell_size": 20}),
    "no contrast normalisation": Option(points={"softening": 0.0}),
    "no augmentation": Option(light=NO_LIGHT),
    "no exposure": Option(light={"exposure": 0.0}),
    "no lamp": Option(light={"lamp_share": 0.0}),
    "no occluders": Option(light={"occluded_share": 0.0}),
    "isotropic directions": Option(training={"balance": 0.0}),
    "16 numbers per leaf": Option(training={"n_numbers": 16}),
    "all numbers per leaf": Option(training={"n_numbers": 0}),
    "5 stages": Option(training={"n_stages": 5}),
    "10 stages": Option(training={"n_stages": 10}),
    "150 ferns": Option(training={"n_ferns": 150}),
    "shrinkage 50": Option(training={"shrinkage": 50.0}),
    "all samples in each search": Option(training={"n_parts": 1}),
    "5 runs": Option(running={"n_runs": 5}),
    "median of runs": Option(running={"use_median": True}),
    "one pass": Option(running={"again_mm": 1e9}),
    "size left free": Option(running={"keep_size": False}),
}


@dataclass(frozen=True)
class Clip:
    gray: np.ndarray  # (N, H, W) uint8
    mesh_px: np.ndarray  # (N, 478, 2)
    points_mm: np.ndarray  # (N, Q, 3)


def read_clip(path, aligner):
    """Return the frames of a clip with a face, their meshes and lifted shapes."""
    capture, gray, px, depth = cv2.VideoCapture(str(path)), [], [], []
    alignment = None
    while True:
        there, frame = capture.read()
        if not there:
            break
        alignment = aligner.follow(np.ascontiguousarray(frame[..., ::-1]), alignment)
        if alignment is not None:
            gray.append(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY))
            px.append(alignment.mesh_px)
            depth.append(alignment.mesh_depth_px)
    px, depth = np.array(px), np.array(depth)
    camera = camera_of(gray[0])
    return Clip(np.array(gray), px, lift(camera, px, depth))


def camera_of(gray):
    height, width = gray.shape
    return camera_for((width, height), FOCAL_AT_640_PX * width / 640)


def lift(camera, mesh_px, depth_px):
    """Return shapes (N, Q, 3): the network's depth in px, scaled like a face of known size."""
    steady = np.concatenate([mesh_px, depth_px[..., None]], axis=2)[:, list(STEADY478)]
    steady = steady - steady.mean(axis=1, keepdims=True)
    distance = camera.focal_px * STEADY_RADIUS_MM / np.sqrt((steady**2).sum(axis=2).mean(axis=1))
    smooth = np.convolve(np.pad(distance, 2, "edge"), np.ones(5) / 5, "valid")[:, None]
    z = smooth + depth_px * smooth / camera.focal_px
    plane = (mesh_px - camera.center_px) * z[..., None] / camera.focal_px
    rows = [*MESH478[:N_INTERNAL], *REPLACEMENTS478, *PUPILS478]
    return np.concatenate([plane, z[..., None]], axis=2)[:, rows]


def pick_frames(points_mm, candidates, count):
    """Return frames that differ most from each other in pose and, three times as much, in shape."""
    centred = points_mm[candidates] - points_mm[candidates].mean(axis=1, keepdims=True)
    middle = centred[((centred - np.median(centred, axis=0)) ** 2).sum(axis=(1, 2)).argmin()]
    turned = np.array([shape @ register_rigid(shape, middle)[0].T for shape in centred])
    places = np.concatenate([centred, 3 * (turned - middle)], axis=1).reshape(len(centred), -1)
    gap = ((places - np.median(places, axis=0)) ** 2).sum(axis=1)
    chosen = [int(gap.argmin())]
    gap = ((places - places[chosen[0]]) ** 2).sum(axis=1)
    while len(chosen) < count:
        chosen.append(int(gap.argmax()))
        gap = np.minimum(gap, ((places - places[chosen[-1]]) ** 2).sum(axis=1))
    return np.array(candidates)[chosen]


def side_lamp(clip, direction):
    """Return the frames lit by a lamp at one side, shaded with the reference's own shape."""
    camera = camera_of(clip.gray[0])
    normals = normal_maps(camera, clip.points_mm, SHAPE_TRIANGLES)
    shade = 0.35 + 0.95 * np.maximum(normals @ (direction / np.linalg.norm(direction)), 0)
    large = [cv2.resize(one.astype(np.float32), camera.size_px) for one in shade]
    return np.array([np.clip(g * s, 0, 255) for g, s in zip(clip.gray, large, strict=True)])


def covered(clip, seed):
    """Return the frames with a grey patch on the face in every second half second."""
    rng, frames = np.random.default_rng(seed), clip.gray.copy()
    points = project(camera_of(clip.gray[0]), clip.points_mm)
    for start in range(0, len(frames), 30):
        place, half = rng.uniform(-0.9, 0.9, 2), rng.uniform(0.35, 0.6, 2)
        level = rng.integers(20, 235)
        for frame, face in zip(frames[start : start + 15], points[start : start + 15], strict=True):
            middle = face.mean(axis=0)
            radius = np.sqrt(((face - middle) ** 2).sum(axis=1).mean())
            x0, y0 = np.maximum(middle + (place - half) * radius, 0).astype(int)
            x1, y1 = np.maximum(middle + (place + half) * radius, 0).astype(int)
            frame[y0:y1, x0:x1] = level
    return frames


def elsewhere(clip, seed):
    """Return the frames with coarse random blocks around the face, new ones every second."""
    rng, frames = np.random.default_rng(seed), clip.gray.copy()
    blocks = clip.gray[0]
    for index, (frame, mesh) in enumerate(zip(frames, clip.mesh_px, strict=True)):
        if index % 25 == 0:
            coarse = rng.integers(0, 255, (12, 16)).astype(np.uint8)
            blocks = cv2.resize(coarse, frame.shape[::-1], interpolation=cv2.INTER_NEAREST)
        oval = mesh[list(OVAL478)]
        outline = oval.mean(axis=0) + 1.08 * (oval - oval.mean(axis=0))
        face = np.zeros_like(frame)
        cv2.fillConvexPoly(face, cv2.convexHull(outline.astype(np.int32)), 255)
        frame[face == 0] = blocks[face == 0]
    return frames


def variants(clip):
    """Return name -> frames (N, H, W) and the step from frame to frame."""
    ramp = np.linspace(0.45, 1.35, clip.gray.shape[2])
    changed = {
        "plain": clip.gray,
        "dark": clip.gray * 0.6,
        "ramp": clip.gray * ramp,
        "lamp left": side_lamp(clip, np.array([0.9, -0.2, -0.4])),
        "lamp right": side_lamp(clip, np.array([-0.9, -0.2, -0.4])),
        "patch 1": covered(clip, 3),
        "patch 2": covered(clip, 4),
        "elsewhere": elsewhere(clip, 5),
    }
    frames = {k: (np.clip(v, 0, 255).astype(np.uint8), 1) for k, v in changed.items()}
    return frames | {"every 4th": (clip.gray, 4), "every 8th": (clip.gray, 8)}


def follow(regressor, camera, settings, frames, first_mm):
    """Return the shapes (N, Q, 3) of frames followed from a first shape, never set right."""
    regression, shapes = Regression(regressor, camera, settings), []
    previous = first_mm
    for frame in frames:
        previous = regression.run(frame, previous).points_mm
        shapes.append(previous)
    return np.array(shapes)


def measure(regressor, settings, clip, tests):
    """Return one line of figures; distances for pictures 640 px wide."""
    camera = camera_of(clip.gray[0])
    scale = 640 / camera.size_px[0]
    reference = scale * project(camera, clip.points_mm)[:, :N_INTERNAL]
    figures = []
    for name, (frames, step) in tests.items():
        shapes = follow(regressor, camera, settings, frames[::step], clip.points_mm[0])
        points = scale * project(camera, shapes)[:, :N_INTERNAL]
        errors = frame_rmse_px(points, reference[::step])
        if name == "plain":
            under = "/".join(f"{100 * np.mean(errors < limit):.1f}" for limit in (3, 4.5, 6))
            shake = jitter(points, still_frames(reference))
            figures.append(f"{under:>17} {np.median(errors):7.2f} {errors.max():5.1f} {shake:6.3f}")
        else:
            figures.append(f"{100 * np.mean(errors < 3):{max(len(name), 5)}.1f}")
    return " ".join(figures)


def header(tests):
    names = " ".join(f"{name:>5}" for name in tests if name != "plain")
    return (
        f"{'':36} {'s':>5} {'<3/4.5/6 px %':>17} {'median':>7} {'max':>5} {'jitter':>6} {names}\n"
    )


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("options", nargs="*", help=f"of: {', '.join(OPTIONS)}; all if none")
    parser.add_argument("--seeds", type=int, default=2, help="regressors per option")
    parser.add_argument("--clips", type=Path, default=REPOSITORY.parent / "shared" / "clips")
    return parser.parse_args()


def main():
    wanted = arguments()
    if not (wanted.clips / "person_a_1.mp4").exists():
        sys.stdout.write(f"skipped: no real clips in {wanted.clips}; --clips names their folder\n")
        return
    aligner = FaceAligner(asset("aligner"))
    setup, test = (read_clip(wanted.clips / f"person_a_{n}.mp4", aligner) for n in (1, 2))
    candidates = [n for n in range(len(setup.gray)) if n not in COVERED]
    chosen = pick_frames(setup.points_mm, candidates, 60)
    camera, tests = camera_of(setup.gray[0]), variants(test)
    sys.stdout.write(header(tests))
    for name in wanted.options or OPTIONS:
        set_settings, train_settings, run_settings = OPTIONS[name].settings()
        for seed in range(1, wanted.seeds + 1):
            rng, start_s = np.random.default_rng(seed), time.process_time()
            samples = make_training_set(
                setup.gray[chosen], camera, setup.points_mm[chosen], rng, set_settings
            )
            regressor, _ = finish(train(samples, rng, train_settings))
            spent_s = time.process_time() - start_s
            line = measure(regressor, run_settings, test, tests)
            sys.stdout.write(f"{name:36} {spent_s:5.1f} {line}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
