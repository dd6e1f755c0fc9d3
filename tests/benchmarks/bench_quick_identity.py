"""How much better a face of one's own is than the mean face, and how soon.

Three performers play a mixed take before three webcams. The training-free tracker follows exact
landmarks (0.7 px of noise, no outline) or the network's, with the mean face throughout or with
`QuickIdentity`; the focal length is known or begins at the picture's width. Real clips have no
truth: there the distance of the landmarks from the solution is compared.

Run: python -m tests.benchmarks.bench_quick_identity [seconds]
"""

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import app  # noqa: F401 - sets up numba's cache before it is imported
from app.capture.video import VideoSource
from app.models import load_aligner
from app.performer.opening import Scenario, open_performer
from app.performer.people import load_person
from app.resources import asset
from core.camera import camera_for, project
from core.energy_tracker import EnergyTracker
from core.evaluation import Truth
from core.face_model import PART_NAMES, load_face_model, neutral_mm
from core.fit_space import fit_space
from core.geometry import head_angles_from_matrix, matrix_from_quaternion, procrustes
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.quick_identity import Personal, QuickIdentity
from core.records import Landmarks2D

CASES = (("mara", 520.0), ("tomas", 620.0), ("ayo", 760.0))
CLIPS = Path(os.environ.get("FACEPUPPET_CLIPS", "../shared/clips"))
MARKS_S = (1, 2, 5, 15)
NOISE_PX = 0.7
#: The front of the face around the origin between the eyes, in mm.
LOWEST_MM, HIGHEST_MM = np.array([-65.0, -55.0, -np.inf]), np.array([65.0, 95.0, 40.0])


@dataclass(frozen=True)
class Film:
    """Landmarks of a film, and the truth where there is one."""

    size_px: tuple[int, int]
    times_s: list[float]
    landmarks: list[Landmarks2D]
    truths: list[Truth]


@dataclass(frozen=True)
class Followed:
    """What tracking a film gave, frame by frame."""

    rotations: np.ndarray
    expressions: np.ndarray
    rms_px: np.ndarray
    offer_ms: np.ndarray
    advance_ms: np.ndarray
    faces: dict[int, Personal]


def watch(source, aligner, seconds) -> Film:
    """Return what the network sees of a source."""
    film = Film(source.size_px, [], [], [])
    found = None
    while (frame := source.read()) is not None and frame.time_s < seconds:
        found = aligner.follow(frame.rgb, found)
        if found is None:
            continue
        film.times_s.append(frame.time_s)
        film.landmarks.append(found.landmarks)
        if hasattr(source, "truth"):
            film.truths.append(source.truth(frame.index))
    return film


def exact(film: Film, focal_px: float) -> Film:
    """Return the film with the true landmarks and noise; the outline is left out."""
    rng, camera, landmarks = np.random.default_rng(0), camera_for(film.size_px, focal_px), []
    for truth, seen in zip(film.truths, film.landmarks, strict=True):
        points, confidence = seen.points_px.copy(), seen.confidence.copy()
        points[:N_INTERNAL] = project(camera, truth.points_mm[:N_INTERNAL])
        points[:N_INTERNAL] += NOISE_PX * rng.normal(size=(N_INTERNAL, 2))
        confidence[N_INTERNAL:] = 0
        blank = np.zeros(N_LANDMARKS, bool), confidence, seen.pupils_px, seen.pupil_confidence
        landmarks.append(Landmarks2D(points, *blank))
    return Film(film.size_px, film.times_s, landmarks, film.truths)


def follow(model, film: Film, focal_px: float | None, *, learn: bool) -> Followed:
    """Track a film, learning the face or not; a focal length of None is unknown."""
    camera = camera_for(film.size_px, focal_px or film.size_px[0])
    space = fit_space(model)
    face = space.face(np.zeros(space.n_identities), np.zeros((N_INTERNAL, 3)))
    tracker, quick = EnergyTracker(face, camera), QuickIdentity(model, camera, bool(focal_px))
    rows, faces = [], {}
    for n, (time_s, seen) in enumerate(zip(film.times_s, film.landmarks, strict=True)):
        solved = tracker.step(seen.points_px, seen.confidence, time_s)
        spent, better = [0.0, 0.0], None
        if learn:
            start = time.process_time()
            quick.offer(
                seen, solved.expression, solved.rotation_wxyz, solved.translation_mm,
                solved.confidence,
            )  # fmt: skip
            middle = time.process_time()
            better = quick.advance()
            spent = [middle - start, time.process_time() - middle]
        if better is not None:
            faces[n] = better
            tracker.use(better.face, better.camera)
        rows.append((solved.rotation_wxyz, solved.expression, solved.rms_px, spent))
    rotations, expressions, rms, spent = (np.array(part) for part in zip(*rows, strict=True))
    return Followed(rotations, expressions, rms, 1e3 * spent[:, 0], 1e3 * spent[:, 1], faces)


def front_vertices(model):
    """Return the skin of the face without ears, neck and skull."""
    skin = np.unique(model.triangles[model.part == PART_NAMES.index("skin")])
    points = model.mean_mm[skin]
    return skin[np.all((points > LOWEST_MM) & (points < HIGHEST_MM), axis=1)]


def neutral_error_mm(neutral, truth, front) -> float:
    """Return the mean distance of neutral faces after a similarity."""
    source, target = neutral[front], truth[front]
    scale, rotation, shift = procrustes(source, target)
    return float(np.linalg.norm(scale * source @ rotation.T + shift - target, axis=1).mean())


def shape_over_time(model, film, followed, person, front) -> str:
    """Return the error of the neutral face with the mean face and at each mark."""
    truth = load_person(asset("people.npz"), model, person).neutral_mm
    mean = neutral_mm(model, np.zeros(model.n_identities))
    out = [neutral_error_mm(mean, truth, front)]
    for mark_s in MARKS_S:
        ready = [n for n in followed.faces if film.times_s[n] <= mark_s]
        shape = followed.faces[ready[-1]].user.neutral_mm if ready else mean
        out.append(neutral_error_mm(shape, truth, front))
    return " ".join(f"{value:5.2f}" for value in out)


def pose_and_expression(film, followed) -> str:
    """Return the mean error of the head angles in degrees and of the coefficients in percent."""
    solved, true = (
        np.array([head_angles_from_matrix(one) for one in matrix_from_quaternion(rotations)])
        for rotations in (followed.rotations, np.array([t.rotation_wxyz for t in film.truths]))
    )
    coefficients = np.array([t.expression for t in film.truths])
    angle = np.rad2deg(np.abs(solved - true).mean())
    return f"{angle:4.2f} {100 * np.abs(followed.expressions - coefficients).mean():4.2f}"


def focal_over_time(film, followed) -> str:
    """Return the focal length and its spread at each mark."""
    out = []
    for mark_s in MARKS_S:
        ready = [n for n in followed.faces if film.times_s[n] <= mark_s]
        face = followed.faces[ready[-1]] if ready else None
        out.append(f"{face.camera.focal_px:4.0f}±{100 * face.focal_spread:2.0f}%" if face else "-")
    return " ".join(out)


def performers(model, aligner, seconds) -> list[Followed]:
    """Print the table of the performers."""
    front, learned = front_vertices(model), []
    print(
        "person landmarks focal | shape mm mean 1s 2s 5s 15s | mean face deg % | own deg % | focal"
    )
    for person, focal_px in CASES:
        with open_performer(Scenario(person=person, focal_px=focal_px)) as source:
            network = watch(source, aligner, seconds)
        for name, film in (("exact", exact(network, focal_px)), ("network", network)):
            for known in (focal_px, None):
                mean = follow(model, film, known, learn=False)
                own = follow(model, film, known, learn=True)
                learned.append(own)
                print(
                    f"{person:5s} {name:7s} {focal_px:.0f} {'known' if known else 'found'} | "
                    f"{shape_over_time(model, film, own, person, front)} | "
                    f"{pose_and_expression(film, mean)} | {pose_and_expression(film, own)} | "
                    f"{focal_over_time(film, own)}",
                    flush=True,
                )
    return learned


def clips(model, aligner, seconds) -> None:
    """Print the distance of the landmarks from the solution in real clips."""
    for path in sorted(CLIPS.glob("*.mp4")):
        with VideoSource(path) as source:
            film = watch(source, aligner, seconds)
        mean, own = (follow(model, film, None, learn=learn) for learn in (False, True))
        after = [n for n, time_s in enumerate(film.times_s) if time_s > MARKS_S[1]]
        print(
            f"{path.name}: rms px mean face {np.median(mean.rms_px[after]):.2f}, own "
            f"{np.median(own.rms_px[after]):.2f}; focal {focal_over_time(film, own)}",
            flush=True,
        )


def main() -> None:
    """Print the tables."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 16.0
    model, aligner = load_face_model(asset("face_model.npz")), load_aligner()
    learned = performers(model, aligner, seconds)
    offers = np.concatenate([one.offer_ms for one in learned])
    pieces = np.concatenate([one.advance_ms for one in learned])
    print(
        f"CPU ms: offer median {np.median(offers):.2f}, advance median {np.median(pieces):.2f}, "
        f"mean {pieces.mean():.2f}, 99 % {np.percentile(pieces, 99):.1f}, most {pieces.max():.1f}"
    )
    clips(model, aligner, seconds)


if __name__ == "__main__":
    main()
