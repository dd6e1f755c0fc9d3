"""Measures the mean error of the landmark network and writes assets/aligner/bias.npz.

`python -m assets.build.aligner_bias` renders people of the face model, from all sides and with
several expressions, aligns every picture, and fits each internal landmark's error, upright and in
mm, by a polynomial of the head's angles as the network itself sees them. Mirror images count too.
The virtual performers take no part in it.
"""

from collections.abc import Iterator

import numpy as np

from app.avatars.build import Head, dressed
from app.avatars.looks import LOOKS
from app.avatars.wardrobe import load_wardrobe
from app.performer.lights import LIGHTS
from app.performer.room import paint_room
from app.render.puppet import Puppet, body_below
from app.render.renderer import Renderer, Scene
from app.render.scene import View, placed
from app.resources import asset
from core.aligner_bias import AlignerBias, features, in_plane
from core.alignment import FaceAligner
from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for, project
from core.face_model import FaceModel, deltas_mm, load_face_model, neutral_mm
from core.geometry import head_angles_from_matrix, matrix_from_head_angles
from core.landmarks import MIRROR, N_INTERNAL

N_PEOPLE, N_KNOBS, SPREAD = 24, 40, 0.9
YAWS_DEG, PITCHES_DEG = (-62, -48, -32, -16, 0, 16, 32, 48, 62), (-25, 0, 25)
EXPRESSIONS = (
    {}, {}, {"jawOpen": 0.5}, {"mouthSmileLeft": 0.7, "mouthSmileRight": 0.7},
    {"browInnerUpLeft": 0.6, "browInnerUpRight": 0.6, "browOuterUpLeft": 0.6,
     "browOuterUpRight": 0.6},
    {"mouthPucker": 0.6}, {"eyeBlinkLeft": 0.9, "eyeBlinkRight": 0.9},
)  # fmt: skip
CAMERA = camera_for((640, 480), 620.0)
#: Landmarks further off than this from the polynomial count less.
ROBUST_MM = 2.0
ROUNDS = 4


def main() -> None:
    """Measure and write."""
    model = load_face_model(asset("face_model.npz"))
    samples = list(measure(model, FaceAligner(asset("aligner"))))
    angles = np.array([angle for angle, _, _ in samples])
    errors = np.array([error for _, error, _ in samples])
    weights = np.array([weight for _, _, weight in samples])
    bias = fitted(angles, errors, weights)
    left = errors - np.einsum("lcf,nf->nlc", bias.coefficients_mm, features(angles))
    for low, high in ((0, 20), (20, 40), (40, 70)):
        near = (np.abs(np.rad2deg(angles[:, 0])) >= low) & (np.abs(np.rad2deg(angles[:, 0])) < high)
        before, after = (
            np.sqrt(np.average((e[near] ** 2).sum(axis=2), weights=weights[near]))
            for e in (errors, left)
        )
        print(f"yaw {low}-{high}: {near.sum()} pictures, {before:.2f} mm, left {after:.2f} mm")
    np.savez_compressed(
        asset("aligner") / "bias.npz", coefficients_mm=bias.coefficients_mm.astype(np.float32)
    )


def measure(model: FaceModel, aligner: FaceAligner) -> Iterator[tuple]:
    """Yield the network's yaw and pitch (2,), errors (60, 2) in mm and weights (60,)."""
    rng = np.random.default_rng(11)
    wardrobe, room = load_wardrobe(asset("."), model), paint_room(CAMERA.size_px, 1)
    renderer, looks, lights = Renderer(), list(LOOKS.values()), list(LIGHTS.values())
    for person in range(N_PEOPLE):
        identity = np.zeros(model.n_identities)
        identity[:N_KNOBS] = rng.normal(0, SPREAD, N_KNOBS)
        head = Head(model, neutral_mm(model, identity), deltas_mm(model, identity))
        avatar = dressed(head, looks[person % len(looks)], wardrobe, str(person))
        puppet = Puppet(renderer, avatar)
        for yaw in YAWS_DEG:
            for pitch in PITCHES_DEG:
                turn = np.deg2rad([yaw, pitch, 0]) + rng.normal(0, 0.08, 3)
                pose = placed(matrix_from_head_angles(*turn), rng.normal([0, 0, 540], [30, 20, 50]))
                named = EXPRESSIONS[rng.integers(len(EXPRESSIONS))]
                expression = np.array([named.get(name, 0.0) for name in EXPRESSION_NAMES])
                gaze = np.tile(rng.normal(0, 0.1, 2), (2, 1))
                items = puppet.items(expression, gaze, pose, body_below(avatar, pose, np.eye(3)))
                scene = Scene(View(CAMERA), lights[rng.integers(len(lights))], items, room)
                picture = np.ascontiguousarray(renderer.draw(scene)[..., :3])
                yield from errors_of(head, expression, pose, aligner, picture)
        puppet.release()
        print(f"person {person + 1} of {N_PEOPLE}", flush=True)


def errors_of(
    head: Head, expression: np.ndarray, pose: np.ndarray, aligner: FaceAligner, picture: np.ndarray
) -> Iterator[tuple]:
    """Yield the sample of one picture, nothing where no face is found."""
    found = aligner.first(picture)
    if found is None:
        return
    rows = head.model.landmark_vertices
    points = head.neutral_mm[rows] + np.tensordot(expression, head.deltas_mm[:, rows], 1)
    true_px = project(CAMERA, points @ pose[:3, :3].T + pose[:3, 3])
    yaw, pitch, roll = head_angles_from_matrix(found.rotation)
    off = found.landmarks.points_px[:N_INTERNAL] - true_px
    upright = off @ in_plane(-roll).T / found.px_per_mm
    yield np.array([yaw, pitch]), upright, found.landmarks.confidence[:N_INTERNAL] + 0.02


def fitted(angles: np.ndarray, errors: np.ndarray, weights: np.ndarray) -> AlignerBias:
    """Return the polynomial of errors (N, 60, 2) at angles (N, 2), robust to single misses."""
    mirrored = errors[:, MIRROR[:N_INTERNAL]] * [-1, 1]
    angles = np.concatenate([angles, angles * [-1, 1]])
    errors = np.concatenate([errors, mirrored])
    weights = np.concatenate([weights, weights[:, MIRROR[:N_INTERNAL]]])
    terms = features(angles)
    out = np.zeros((N_INTERNAL, 2, terms.shape[1]))
    for landmark in range(N_INTERNAL):
        trust = weights[:, landmark].copy()
        for _ in range(ROUNDS):
            gram = (terms * trust[:, None]).T @ terms + 1e-3 * np.eye(terms.shape[1])
            solved = np.linalg.solve(gram, (terms * trust[:, None]).T @ errors[:, landmark])
            missed = np.linalg.norm(errors[:, landmark] - terms @ solved, axis=1)
            trust = weights[:, landmark] / np.maximum(missed / ROBUST_MM, 1.0)
        out[landmark] = solved.T
    return AlignerBias(out)


if __name__ == "__main__":
    main()
