"""Takes made to be measured: one-sided faces, heads that move as in the papers' films, a statue."""

import numpy as np

from app.performer import acts
from app.performer.acts import Act
from app.performer.curves import through

#: Faces with two unlike sides [FaceIt19, fig. 3].
ONE_SIDED: dict[str, dict[str, float]] = {
    "smile left": {"mouthSmileLeft": 0.85, "cheekSquintLeft": 0.45, "mouthDimpleLeft": 0.2},
    "smile right": {"mouthSmileRight": 0.85, "cheekSquintRight": 0.45, "mouthDimpleRight": 0.2},
    "wink left": {"eyeBlinkLeft": 1.0, "cheekSquintLeft": 0.5},
    "wink right": {"eyeBlinkRight": 1.0, "cheekSquintRight": 0.5},
    "jaw left": {"jawLeft": 0.9, "jawOpen": 0.1},
    "jaw right": {"jawRight": 0.9, "jawOpen": 0.1},
    "brow left": {"browOuterUpLeft": 0.95, "browDownRight": 0.45},
    "brow right": {"browOuterUpRight": 0.95, "browDownLeft": 0.45},
    "mouth left": {"mouthLeft": 0.9},
    "mouth right": {"mouthRight": 0.9},
    "sneer left": {"noseSneerLeft": 0.8, "mouthUpperUpLeft": 0.7},
    "sneer right": {"noseSneerRight": 0.8, "mouthUpperUpRight": 0.7},
    "half frown left": {"mouthFrownLeft": 0.8, "mouthStretchLeft": 0.4},
    "half frown right": {"mouthFrownRight": 0.8, "mouthStretchRight": 0.4},
}

#: Length of a film of the Boston University head tracking database, at 30 frames per second.
MOTION_S = 200 / 30
#: The largest yaw, pitch, roll in degrees and shift in mm of a film.
_RANGE = np.array([57.0, 27.0, 27.0, 110.0, 50.0, 130.0])


def asymmetric(rng: np.random.Generator) -> Act:
    """Return one-sided faces in any order."""
    names = [list(ONE_SIDED)[i] for i in rng.permutation(len(ONE_SIDED))]
    return acts.pull_faces(names, rng, ONE_SIDED)


def head_motion(rng: np.random.Generator) -> Act:
    """Return free movement of the head as in the Boston University films.

    It starts at rest and facing the camera, as those do. Every move turns the head far about
    one axis, some way about the others, and takes it to another place.
    """
    times = acts.grid(MOTION_S)
    knots, poses = [0.0, 0.3], [np.zeros(6), np.zeros(6)]
    axes: list[int] = []
    while knots[-1] < MOTION_S - 1.4:
        axes = axes or [int(axis) for axis in rng.permutation(3)]
        pose, main = _RANGE * rng.uniform(-0.45, 0.45, 6), axes.pop()
        for far in (main, int(rng.integers(3, 6))):
            pose[far] = _RANGE[far] * rng.uniform(0.65, 1.0) * rng.choice([-1.0, 1.0])
        way = float(np.abs((pose - poses[-1]) / _RANGE).max())
        knots.append(knots[-1] + (0.35 + 0.35 * way) * rng.uniform(0.85, 1.2))
        poses.append(pose)
    knots += [MOTION_S, MOTION_S + 1.0]
    moved = through(times, np.array(knots), np.array([*poses, np.zeros(6), np.zeros(6)]))
    still = np.zeros((len(times), len(acts.weights({}))))
    return Act(still, np.deg2rad(moved[:, :3]), moved[:, 3:])


def statue(rng: np.random.Generator) -> Act:
    """Return a face in which nothing moves; what a tracker then sees is the webcam's noise."""
    return acts.rest(MOTION_S)
