"""How well a performer's turned head is followed, by what the regressor is trained on.

Each regressor follows the mixed take of a virtual performer, of which the truth is known. With
`exact`, the shapes of the setup pictures are the true ones: what is left is the regressor's part;
else they come from the generic aligner's landmarks. `stays` follows nothing: on every frame with
the head beyond 40 degrees the regressor goes on for 8 rounds from the true shape, and from the
truth turned back by 12 degrees.

Run: python -m tests.benchmarks.turned_heads [--person NAME] [--focal PX] [--seeds N]
"""

import argparse
import sys
from dataclasses import replace

import numpy as np

from app.models import live_tracker, load_models
from app.performer.opening import PEOPLE, Scenario, open_performer, setup_pictures
from app.setup_steps import Pictures, make_profile, unseen
from core.camera import project
from core.evaluation import against_truth, frame_rmse_px
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
)
from core.landmarks import N_LANDMARKS
from core.pipeline import gray_from_rgb
from core.records import SetupImages
from core.regressor import Regression
from core.regressor_trainer import train
from core.setup_plan import standard_for
from core.training_set import TrainingSetSettings, make_training_set
from core.turned_views import TurnSettings
from tests.synthetic_face import finish

OPTIONS = {
    "pictures only as taken": TurnSettings(further_deg=()),
    "ours": TurnSettings(),
    "up to 24 degrees further": TurnSettings(further_deg=(12.0, 24.0), limit_deg=62.0),
    "their guesses turned less": TurnSettings(guess_turn_rad=0.07),
}
TURNED_DEG, BACK_DEG, ROUNDS = 40.0, 12.0, 8


def yaw_deg(truth):
    rotation = matrix_from_quaternion(truth.rotation_wxyz)
    return float(np.rad2deg(head_angles_from_matrix(rotation)[0]))


def profile_of(models, scenario):
    """Return the profile made with the generic aligner, and the truth of its pictures."""
    shots = setup_pictures(scenario)
    names = tuple(name for name, _, _ in shots)
    standard = np.stack([standard_for(name) for name in names])
    images = SetupImages(tuple(frame.rgb for _, frame, _ in shots), names, standard)
    found = [models.aligner.first(image) for image in images.images]
    landmarks = tuple(one.landmarks if one else unseen() for one in found)
    steps = make_profile(
        models.face_model, Pictures(images, landmarks, ()), None, np.random.default_rng(1)
    )
    (profile, used), _ = finish(steps)
    gray = [gray_from_rgb(image) for image in used.images]
    truths = {name: truth.points_mm for name, _, truth in shots}
    return profile, gray, np.array([truths[name] for name in profile.names])


def stays_px(regressor, camera, true_camera, frames, truths):
    """Return the RMSE after many rounds on frames of turned heads."""
    regression, errors = Regression(regressor, camera), []
    # Another focal length sees the same picture at another distance.
    nearer = np.array([1, 1, camera.focal_px / true_camera.focal_px])
    for frame, truth in zip(frames, truths, strict=True):
        yaw = yaw_deg(truth)
        if abs(yaw) < TURNED_DEG:
            continue
        true_px = project(true_camera, truth.points_mm[None, :N_LANDMARKS])
        for back_deg in (0.0, BACK_DEG):
            points = truth.points_mm * nearer
            turn = matrix_from_head_angles(-np.sign(yaw) * np.deg2rad(back_deg), 0, 0)
            center = points.mean(axis=0)
            points = (points - center) @ turn.T + center
            for _ in range(ROUNDS):
                points = regression.run(frame.gray, points).points_mm
            found_px = project(camera, points[None, :N_LANDMARKS])
            errors.append(frame_rmse_px(found_px, true_px)[0])
    return float(np.mean(errors))


def line(report, stays):
    bins = [f"{name} {one['rmse_px']['mean']:.2f}" for name, one in report["by_yaw"].items()]
    under = "/".join(f"{100 * share:.1f}" for share in report["share_under_px"].values())
    return f"{under:>17}  {'  '.join(bins)}  stays {stays:.2f} px"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--person", choices=PEOPLE, default=PEOPLE[0])
    parser.add_argument("--focal", type=float, default=620.0)
    parser.add_argument("--seeds", type=int, default=2)
    wanted, models = parser.parse_args(), load_models()
    scenario = Scenario(person=wanted.person, focal_px=wanted.focal, seed=1)
    profile, gray, true_mm = profile_of(models, scenario)
    with open_performer(Scenario(person=wanted.person, focal_px=wanted.focal, seed=2)) as source:
        frames = list(iter(source.read, None))
        truths, true_camera = [source.truth(n) for n in range(len(frames))], source.camera
    sys.stdout.write(f"{'':40} {'<3/4.5/6 px %':>17}  mean px by yaw\n")
    for name, turning in OPTIONS.items():
        settings = TrainingSetSettings(turning=turning)
        for exact in (False, True):
            camera = true_camera if exact else profile.camera
            shapes_mm = true_mm if exact else profile.shapes.points_mm
            for seed in range(1, wanted.seeds + 1):
                rng = np.random.default_rng(seed)
                samples = make_training_set(gray, camera, shapes_mm, rng, settings)
                regressor, _ = finish(train(samples, rng))
                changed = replace(profile, camera=camera, regressor=regressor)
                tracker = live_tracker(models, changed)
                report = against_truth([tracker.step(f) for f in frames], truths, true_camera)
                stays = stays_px(regressor, camera, true_camera, frames, truths)
                label = f"{name}{', exact' if exact else ''}, seed {seed}"
                sys.stdout.write(f"{label:40} {line(report, stays)}\n")
                sys.stdout.flush()


if __name__ == "__main__":
    main()
