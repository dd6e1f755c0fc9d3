"""Compares the training-free solvers on the virtual performers, without drawing them.

The true landmarks of a take are projected, with what a network does to them: noise, a bias of
each landmark, guesses where it sees nothing. Solved with the mean face and with one fitted to
the performer's identity, all against the truth of the take.

Run: python -m tests.benchmarks.energy_solvers [solvers|bounds|smoothness|parts|noise ...]
"""

import sys
import time
from dataclasses import dataclass, replace

import numpy as np

from app.performer.people import CAST, load_person
from app.performer.takes import make_take
from app.performer.truth import Script
from app.resources import asset
from core.camera import camera_for, project
from core.contour import contour_points, outward_directions
from core.energy_terms import EnergySettings, JointSettings, PaperSettings
from core.energy_tracker import EnergyTracker
from core.evaluation import jitter
from core.face_model import load_face_model
from core.fit_space import Face, fit_space, fit_vertices
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.landmark_confidence import smooth_step
from core.landmarks import N_INTERNAL

FPS = 30
CAMERA = camera_for((640, 480), 620.0)
TAKES = ("still", "talking", "head_turns", "fast_motion", "expressions")
#: Of the network at 640x480: white noise from frame to frame, its usual bias, a guess.
NOISE_PX, BIAS_PX, GUESS_PX = 0.2, 0.8, 4.0


@dataclass(frozen=True)
class Observed:
    """A take as the network sees it: (F, 75, 2), (F, 75), (F,), and the F truths."""

    points_px: np.ndarray
    confidence: np.ndarray
    times_s: np.ndarray
    truths: list


@dataclass(frozen=True)
class Cast:
    """A performer: the true face, the best one of the model, and the mean face."""

    name: str
    person: object
    true: Face
    fitted: Face
    mean: Face


def performer(model, space, name):
    person = load_person(asset("people.npz"), model, name)
    vertices, strips, replacements = fit_vertices(model)
    true = Face(
        person.neutral_mm[vertices], person.deltas_mm[:, vertices].astype(float), strips,
        replacements,
    )  # fmt: skip
    modes = space.identity_modes_mm.reshape(-1, space.n_identities)
    left = (true.neutral_mm - space.mean_mm).ravel()
    identity = np.linalg.solve(modes.T @ modes + np.eye(len(modes.T)), modes.T @ left)
    none = np.zeros((N_INTERNAL, 3))
    return Cast(
        name, person, true, space.face(identity, none), space.face(0 * identity, none)
    )  # fmt: skip


def normals_of(model, person):
    """Return the outward normals (60, 3) of the internal landmarks of the face at rest."""
    points = person.neutral_mm
    corners = points[model.triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(points)
    for c in range(3):
        np.add.at(normals, model.triangles[:, c], flat)
    normals = normals[model.landmark_vertices]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12
    # Whichever way the triangles are wound: the nose looks at the camera, -z.
    return normals * -np.sign(normals[:, 2].sum())


def observe(model, cast, take_name, *, noise_px=NOISE_PX, bias_px=BIAS_PX, most=450, seed=0):
    """Return what the network would see of a take."""
    take = make_take(take_name, seed)
    script = Script(take, cast.person, model, CAMERA.focal_px)
    rng = np.random.default_rng([seed, len(take_name)])
    bias = bias_px * rng.normal(size=(75, 2))
    normals = normals_of(model, cast.person)
    outward = outward_directions(cast.true.neutral_mm, cast.true.strips)
    points, confidences, truths = [], [], []
    n_frames = min(most, int(take.duration_s * FPS))
    for i in range(n_frames):
        truth = script.truth(i / FPS)
        turned = matrix_from_quaternion(truth.rotation_wxyz)
        posed = cast.true.points_mm(truth.expression[None])[0] @ turned.T + truth.translation_mm
        rim = contour_points(cast.true.neutral_mm, posed[None], turned[None], cast.true.strips)[0]
        shown = project(CAMERA, posed[np.concatenate([np.arange(N_INTERNAL), rim])])
        seen = smooth_step(-(normals @ turned[2]), -0.1, 0.3)
        side = outward @ turned[2]
        edge = 0.6 * np.where(side > 0, 1 - smooth_step(side, 0.7, 0.95), 1 + 0.75 * side)
        confidence = np.concatenate([seen, edge])
        guess = GUESS_PX * (1 - np.concatenate([seen, np.ones(15)]))[:, None]
        wrong = bias * (1 + guess) + noise_px * rng.normal(size=(75, 2))
        points.append(shown + wrong)
        confidences.append(confidence)
        truths.append(truth)
    times = np.arange(n_frames) / FPS
    return Observed(np.array(points), np.array(confidences), times, truths)


def follow(face, settings, seen):
    """Return the solved frames of a take, the processor time and the state of each."""
    tracker = EnergyTracker(face, CAMERA, settings)
    tracker.step(seen.points_px[0], seen.confidence[0], 0.0)
    tracker.reset()
    solved, costs, states = [], [], []
    for points, confidence, time_s in zip(
        seen.points_px, seen.confidence, seen.times_s, strict=True
    ):
        start_s = time.process_time()
        solved.append(tracker.step(points, confidence, time_s))
        costs.append(time.process_time() - start_s)
        states.append(tracker.state)
    return solved, np.array(costs), states


def angles_deg(rotations):
    return np.rad2deg([head_angles_from_matrix(matrix_from_quaternion(r)) for r in rotations])


def figures(solved, costs, states, seen):
    """Return the errors of a take by name."""
    truths = seen.truths
    angles = angles_deg([s.rotation_wxyz for s in solved])
    wrong = angles - angles_deg([t.rotation_wxyz for t in truths])
    shift = np.array([s.translation_mm for s in solved]) - [t.translation_mm for t in truths]
    expression = np.array([s.expression for s in solved])
    true = np.array([t.expression for t in truths])
    off = np.abs(expression - true)
    yaw, pitch, roll = np.abs(wrong).mean(axis=0)
    still = np.ones(len(solved), bool)
    return {
        "roll": roll, "pitch": pitch, "yaw": yaw, "mean": (roll + pitch + yaw) / 3,
        "worst": np.abs(wrong).max(),
        "x mm": np.abs(shift[:, 0]).mean(), "y mm": np.abs(shift[:, 1]).mean(),
        "z mm": np.abs(shift[:, 2]).mean(),
        "coef": off.mean(), "active": off[true > 0.3].mean() if (true > 0.3).any() else np.nan,
        "idle": off[true < 0.02].mean(),
        "jit deg": max(jitter(wrong[15:, i], still[15:]) for i in range(3)),
        "jit coef": jitter((expression - true)[15:], still[15:]),
        "rms px": np.mean([s.rms_px for s in solved]),
        "first": off[0].mean(),
        "steps": np.mean([s.steps_taken for s in states]),
        "outside": np.mean([s.outside for s in states]),
        "ms": 1e3 * np.median(costs),
    }  # fmt: skip


def everybody(people):
    model = load_face_model(asset("face_model.npz"))
    space = fit_space(model)
    return model, [performer(model, space, name) for name in people]


def report(title, variants, *, takes=TAKES, people=tuple(CAST), faces=("mean", "fitted"), **how):
    """Print one row per variant: means over performers and takes, jitter of the first take."""
    model, cast = everybody(people)
    seen = {(c.name, t): observe(model, c, t, **how) for c in cast for t in takes}
    print(f"\n{title}")
    for face in faces:
        for label, settings in variants.items():
            rows = {
                (c.name, t): figures(
                    *follow(getattr(c, face), settings, seen[c.name, t]), seen[c.name, t]
                )
                for c in cast
                for t in takes
            }
            mean = {k: np.nanmean([r[k] for r in rows.values()]) for k in next(iter(rows.values()))}
            for key in ("jit deg", "jit coef"):
                mean[key] = np.mean([r[key] for (_, take), r in rows.items() if take == takes[0]])
            row = "  ".join(f"{k} {v:.3g}" for k, v in mean.items())
            print(f"{face:7s}{label:30s}{row}", flush=True)


def paper(filtered=False, **changes):
    settings = EnergySettings(solver="paper", paper=PaperSettings(**changes))
    return settings if filtered else replace(settings, pose_filter=None)


def joint(**changes):
    return EnergySettings(joint=JointSettings(**changes))


def barrier(**changes):
    return paper(bounds="barrier", **changes)


SOLVERS = {
    "paper": paper(),
    "paper, pose filtered": paper(filtered=True),
    "joint, unfiltered": EnergySettings(pose_filter=None),
    "joint": EnergySettings(),
    "joint, 75 landmarks": EnergySettings(n_landmarks=75),
}
#: Eq. 12 as printed, at several weights, with wider walls, and bounds in its place.
BOUNDS = {
    "box": paper(),
    **{f"printed, weight {w:g}": barrier(barrier=w) for w in (1.0, 10.0, 100.0, 1e4)},
    **{
        f"walls {b:g} wide at {a:g}": barrier(barrier_a=a, barrier_b=b)
        for a, b in ((1.002, 2e-4), (1.01, 1e-3), (1.05, 1e-2))
    },
    "walls 0.001, weight 5": barrier(barrier=5.0, barrier_a=1.01, barrier_b=1e-3),
}
#: Eq. 9: rad^2 and mm^2 added with one weight, as printed, and with a weight each.
SMOOTHNESS = {
    "none": paper(rotation_smoothness=0.0, translation_smoothness=0.0),
    **{
        f"one weight {w:g}": paper(rotation_smoothness=w, translation_smoothness=w)
        for w in (1.0, 68.0, 1e4)
    },
    **{f"rotation {w:g}": paper(rotation_smoothness=w) for w in (1e4, 1e5, 1e6)},
}
#: What is left of ours without one of its parts.
PARTS = {
    "joint": joint(),
    "without robust distance": joint(robust=1e6),
    "without memory": joint(memory=1e3),
    "without sparsity": joint(slope=0.0),
    "with a fixed noise": joint(noise_mm=(1.0, 1.0)),
    "with all the outline": joint(outline_weight=1.0),
    "without the outline": joint(outline_weight=0.0),
    "three iterations": joint(iterations=3),
}


def main(names):
    for name in names or ("solvers",):
        if name == "solvers":
            report("Solvers; roll, pitch, yaw: mean absolute error in degrees", SOLVERS)
        elif name == "bounds":
            report("Eq. 12", BOUNDS, people=("mara", "ayo"), faces=("fitted",), most=200)
        elif name == "smoothness":
            report("Eq. 9", SMOOTHNESS, people=("mara", "ayo"), faces=("fitted",), most=200)
        elif name == "parts":
            report("Parts of the joint solver", PARTS, people=("mara", "ayo"), most=200)
        elif name == "noise":
            for noise_px in (0.12, 0.2, 0.3):
                chosen = {k: SOLVERS[k] for k in ("paper", "joint", "joint, 75 landmarks")}
                title, takes = f"Noise {noise_px} px", ("still", "fast_motion")
                report(title, chosen, takes=takes, faces=("fitted",), noise_px=noise_px, most=200)
        else:
            sys.exit(f"no study is called {name!r}")


if __name__ == "__main__":
    main(sys.argv[1:])
