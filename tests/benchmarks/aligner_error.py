"""How far the network's landmarks are from the truth, before and after its foretold error is off.

`python -m tests.benchmarks.aligner_error` looks at the setup pictures of the three performers, who
had no part in learning that error, and prints the mean distance of the inner landmarks that are
seen, in px at 640x480.
"""

import numpy as np

import app  # noqa: F401 - sets up numba's cache before it is imported
from app.models import load_aligner
from app.performer.opening import PEOPLE, Scenario, setup_pictures
from app.resources import asset
from core.alignment import FaceAligner
from core.camera import camera_for, project
from core.landmarks import N_INTERNAL

SEEN = 0.3


def errors_px(aligner: FaceAligner, person: str, focal_px: float = 620.0) -> np.ndarray:
    """Return the distances of all landmarks that are seen in a performer's pictures."""
    camera, found = camera_for((640, 480), focal_px), []
    for _, frame, truth in setup_pictures(Scenario(person=person, focal_px=focal_px)):
        seen = aligner.first(frame.rgb)
        if seen is None:
            continue
        true_px = project(camera, truth.points_mm[:N_INTERNAL])
        off = np.linalg.norm(seen.landmarks.points_px[:N_INTERNAL] - true_px, axis=1)
        found.append(off[seen.landmarks.confidence[:N_INTERNAL] > SEEN])
    return np.concatenate(found)


def main() -> None:
    """Print the mean errors, a row per person."""
    raw, corrected = FaceAligner(asset("aligner")), load_aligner()
    print("person    network   corrected")
    for person in PEOPLE:
        means = [errors_px(aligner, person).mean() for aligner in (raw, corrected)]
        print(f"{person:8}{means[0]:6.2f} px{means[1]:9.2f} px", flush=True)


if __name__ == "__main__":
    main()
