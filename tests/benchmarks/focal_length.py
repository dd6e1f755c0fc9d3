"""How well the focal length is found with exact landmarks and with automatic ones.

`python -m tests.benchmarks.focal_length` lets three performers follow the 60 prompts before three
lenses, and prints the errors as a table. Exact landmarks are the truth with noise, as a careful
person would place them, without an outline; of heads turned far only the near half is placed.
Automatic ones are the generic aligner's. `--exact` leaves the automatic ones, which need pictures,
out; `--noise PX` places the exact ones with other noise.
"""

import argparse
from collections.abc import Iterator

import numpy as np

import app  # noqa: F401 - sets up numba's cache before it is imported
from app.models import load_aligner
from app.performer.opening import FOCAL_LENGTHS_PX, PEOPLE, Scenario, setup_pictures
from app.performer.people import load_person
from app.performer.prompts import setup_take
from app.performer.truth import Script
from app.resources import asset
from core.calibration import CalibrationSettings, estimate_focal
from core.camera import camera_for, project
from core.evaluation import Truth
from core.face_model import FaceModel, load_face_model
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.landmarks import N_INTERNAL, N_LANDMARKS, NAMES
from core.records import Landmarks2D
from core.setup_plan import standard_for

SIZE_PX = (640, 480)
NOISE_PX, TURNED_DEG = 0.5, 50.0


def truths(
    model: FaceModel, person: str, focal_px: float, seed: int = 0
) -> Iterator[tuple[str, Truth]]:
    """Yield the shots of a setup and what is really there; nothing is drawn for that."""
    session = setup_take(seed)
    cast = load_person(asset("people.npz"), model, person)
    script = Script(session.take, cast, model, focal_px)
    for name, time_s in zip(session.names, session.times_s, strict=True):
        yield name, script.truth(float(time_s))


def exact_landmarks(
    truth: Truth, focal_px: float, rng: np.random.Generator, noise_px: float = NOISE_PX
) -> Landmarks2D:
    """Return the true landmarks with noise, placed by hand, but for a turned head's far side."""
    yaw = np.rad2deg(head_angles_from_matrix(matrix_from_quaternion(truth.rotation_wxyz))[0])
    true_px = project(camera_for(SIZE_PX, focal_px), truth.points_mm)
    points, confidence = np.zeros((N_LANDMARKS, 2)), np.zeros(N_LANDMARKS)
    points[:N_INTERNAL] = true_px[:N_INTERNAL] + rng.normal(0, noise_px, (N_INTERNAL, 2))
    far = "R_" if yaw < 0 else "L_"
    hidden = [abs(yaw) > TURNED_DEG and name.startswith(far) for name in NAMES[:N_INTERNAL]]
    confidence[:N_INTERNAL] = np.where(hidden, 0.0, 1.0)
    return Landmarks2D(points, confidence > 0, confidence, true_px[N_LANDMARKS:], np.ones(2))


def found_px(model: FaceModel, landmarks: list[tuple[str, Landmarks2D]]) -> float:
    """Return the focal length found from named landmarks."""
    standard = np.stack([standard_for(name) for name, _ in landmarks])
    each = [one for _, one in landmarks]
    steps = estimate_focal(model, SIZE_PX, each, standard, CalibrationSettings())
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value.camera.focal_px


def found_from_exact(
    model: FaceModel, person: str, focal_px: float, seed: int = 0, noise_px: float = NOISE_PX
) -> float:
    """Return the focal length found from exact landmarks."""
    rng = np.random.default_rng(seed)
    shots = truths(model, person, focal_px, seed)
    placed = [(name, exact_landmarks(one, focal_px, rng, noise_px)) for name, one in shots]
    return found_px(model, placed)


def found_from_pictures(model: FaceModel, aligner, person: str, focal_px: float) -> float:
    """Return the focal length found from the aligner's landmarks."""
    pictures = setup_pictures(Scenario(person=person, focal_px=focal_px, seed=1))
    found = ((name, aligner.first(frame.rgb)) for name, frame, _ in pictures)
    return found_px(model, [(name, one.landmarks) for name, one in found if one is not None])


def main() -> None:
    """Print the errors in percent: a row per person, exact / automatic for each lens."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--exact", action="store_true", help="exact landmarks only")
    parser.add_argument("--noise", type=float, default=NOISE_PX, metavar="PX")
    args = parser.parse_args()
    model, aligner = load_face_model(asset("face_model.npz")), load_aligner()
    print("person " + "".join(f"{focal_px:>16.0f} px" for focal_px in FOCAL_LENGTHS_PX))
    for row, person in enumerate(PEOPLE):
        print(f"{person:7}", end="", flush=True)
        for column, focal_px in enumerate(FOCAL_LENGTHS_PX):
            # Other noise in every cell.
            found = found_from_exact(model, person, focal_px, 3 * row + column, args.noise)
            cell = f"{100 * (found / focal_px - 1):+.1f}"
            if not args.exact:
                found = found_from_pictures(model, aligner, person, focal_px)
                cell += f" / {100 * (found / focal_px - 1):+.1f}"
            print(f"{cell:>19}", end="", flush=True)
        print()


if __name__ == "__main__":
    main()
