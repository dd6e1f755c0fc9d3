"""Runs the solvers alone on what was seen of a film, with a face and a camera that are known."""

import time
from dataclasses import dataclass

import numpy as np

from app.models import Models
from app.studies.film import Film, learned
from app.studies.measures import coefficient_errors, pose_errors, shake
from core.energy_tracker import EnergySettings, EnergyTracker, Solved
from core.evaluation import Truth
from core.fit_space import Face, face_at
from core.records import Camera, FloatArray

#: The first frames, in which filters settle, do not count for noise.
_SETTLING = 15


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A film with the face of its performer.

    Attributes:
        film: Of a performer.
        face: Learned from it, as `track` does.
        camera: The true one.
    """

    film: Film
    face: Face
    camera: Camera


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What a solver made of a film.

    Attributes:
        solved: The frames in which a face was seen.
        truths: Of them.
        cost_ms: (N,) processor time of each.
    """

    solved: tuple[Solved, ...]
    truths: tuple[Truth, ...]
    cost_ms: FloatArray


def case_of(film: Film, models: Models) -> Case:
    """Return the film with its performer's face.

    Raises:
        ValueError: The film is not of a performer.
    """
    if film.camera is None:
        raise ValueError(f"{film.name} is not of a performer")
    return Case(film, face_at(models.face_model, learned(film, models)), film.camera)


def solve(case: Case, settings: EnergySettings, anew: bool = False) -> Run:
    """Return what a solver makes of a film.

    Args:
        case: The film.
        settings: The solver.
        anew: Every frame is solved as if it were the first.
    """
    tracker = EnergyTracker(case.face, case.camera, settings)
    seen = [(n, one.landmarks) for n, one in enumerate(case.film.seen) if one is not None]
    solved, cost_s = [], []
    # Kernels that are called for the first time are compiled: not part of the cost.
    tracker.step(seen[0][1].points_px, seen[0][1].confidence, 0.0)
    tracker.reset()
    for n, landmarks in seen:
        if anew:
            tracker.reset()
        time_s, before_s = float(case.film.times_s[n]), time.thread_time()
        solved.append(tracker.step(landmarks.points_px, landmarks.confidence, time_s))
        cost_s.append(time.thread_time() - before_s)
    truths = tuple(case.film.truths[n] for n, _ in seen)
    return Run(tuple(solved), truths, 1000 * np.array(cost_s))


def figures_of(runs: list[Run]) -> dict[str, float]:
    """Return the errors over several films: angles, place, coefficients, distance, cost."""
    degrees, mm = _mean_pose(runs)
    solved = [one for run in runs for one in run.solved]
    truths = [one for run in runs for one in run.truths]
    every, shown = coefficient_errors(solved, truths)
    return {
        "rotation deg": degrees,
        "place mm": mm,
        "coefficients": every,
        "shown": shown,
        "landmarks px": float(np.mean([one.rms_px for one in solved])),
        "ms": float(np.median(np.concatenate([run.cost_ms for run in runs]))),
    }


def noise_of(run: Run) -> tuple[float, float]:
    """Return the largest noise of an angle in degrees and the mean one of coefficients."""
    kept = run.solved[_SETTLING:]
    errors = pose_errors(kept, run.truths[_SETTLING:])
    return float(shake(errors.degrees).max()), float(
        shake(np.array([one.expression for one in kept])).mean()
    )


def _mean_pose(runs: list[Run]) -> tuple[float, float]:
    errors = [pose_errors(run.solved, run.truths) for run in runs]
    degrees = np.abs(np.concatenate([e.degrees for e in errors])).mean()
    return float(degrees), float(np.abs(np.concatenate([e.mm for e in errors])).mean())
