"""How well the focal length is found with exact landmarks and with automatic ones.

`python -m tests.benchmarks.focal_length` films the 60 prompts with three performers and three
lenses. Exact landmarks are the truth with 0.7 px of noise, as a careful person would place them,
without an outline and without the pictures turned beyond 75 degrees; automatic ones are the
generic aligner's.
"""

import numpy as np

import app  # noqa: F401 - sets up numba's cache before it is imported
from app.models import load_aligner
from app.performer.opening import Scenario, setup_pictures
from app.resources import asset
from core.calibration import CalibrationSettings, estimate_focal
from core.camera import camera_for, project
from core.evaluation import Truth
from core.face_model import load_face_model
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.landmarks import N_INTERNAL, N_LANDMARKS, NAMES
from core.records import Landmarks2D
from core.setup_plan import standard_for

NOISE_PX, FURTHEST_DEG, TURNED_DEG = 0.7, 75.0, 50.0
CASES = (("mara", 520.0), ("tomas", 620.0), ("ayo", 760.0))


def exact_landmarks(truth: Truth, focal_px: float, rng) -> Landmarks2D | None:
    """Return the true landmarks with noise; the far side of a turned head is hardly trusted."""
    yaw = np.rad2deg(head_angles_from_matrix(matrix_from_quaternion(truth.rotation_wxyz))[0])
    if abs(yaw) > FURTHEST_DEG:
        return None
    true_px = project(camera_for((640, 480), focal_px), truth.points_mm)
    points, confidence = np.zeros((N_LANDMARKS, 2)), np.zeros(N_LANDMARKS)
    points[:N_INTERNAL] = true_px[:N_INTERNAL] + rng.normal(0, NOISE_PX, (N_INTERNAL, 2))
    far = "R_" if yaw < 0 else "L_"
    hidden = [abs(yaw) > TURNED_DEG and name.startswith(far) for name in NAMES[:N_INTERNAL]]
    confidence[:N_INTERNAL] = np.where(hidden, 0.1, 1.0)
    edited = np.zeros(N_LANDMARKS, bool)
    return Landmarks2D(points, edited, confidence, true_px[N_LANDMARKS:], np.ones(2))


def found_px(model, landmarks) -> float:
    """Return the focal length found from (name, landmarks) pairs, None being left out."""
    seen = [(name, one) for name, one in landmarks if one is not None]
    standard = np.stack([standard_for(name) for name, _ in seen])
    steps = estimate_focal(
        model, (640, 480), [one for _, one in seen], standard, CalibrationSettings()
    )
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value.camera.focal_px


def main() -> None:
    """Print the errors."""
    model, aligner = load_face_model(asset("face_model.npz")), load_aligner()
    for person, focal_px in CASES:
        rng = np.random.default_rng(0)
        pictures = setup_pictures(Scenario(person=person, focal_px=focal_px))
        exact = [(name, exact_landmarks(truth, focal_px, rng)) for name, _, truth in pictures]
        found = ((name, aligner.first(frame.rgb)) for name, frame, _ in pictures)
        automatic = [(name, one and one.landmarks) for name, one in found]
        errors = [100 * (found_px(model, each) / focal_px - 1) for each in (exact, automatic)]
        print(
            f"{person} {focal_px:.0f} px: exact {errors[0]:+.1f} %, automatic {errors[1]:+.1f} %",
            flush=True,
        )


if __name__ == "__main__":
    main()
