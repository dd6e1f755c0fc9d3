"""A face as the training-free solvers look at it: tables of the fitted landmarks and the outline.

[FaceIt19, sec. 4] fits the 68 landmarks of the iBUG scheme. Of our 75 these are 51 internal ones;
the scheme's 17 along the jaw have counterparts in our 15 of the outline, and the two wings of the
nose make up the number. The other seven (middle of the lids, lower end of the brows, a point on
the bridge) are used on request.
"""

from dataclasses import dataclass

import numpy as np

from core.contour import fixed_points, outward_directions
from core.fit_space import Face
from core.kernels.energy import N_POSE, FaceTables, Workspace
from core.landmarks import GROUPS, N_INTERNAL, N_LANDMARKS, NAMES, TO_IBUG68
from core.records import I32, FloatArray

#: The wings of the nose stand in for the two jaw landmarks that we do not have.
_WINGS = tuple(NAMES.index(name) for name in ("R_ala", "L_ala"))
#: What moves no landmark by more than this does not count as moving it, mm.
_NO_MOTION_MM = 0.02
#: Landmarks that expressions hardly move [FaceIt19, rigid head pose estimation].
ROBUST: tuple[int, ...] = tuple(
    NAMES.index(name)
    for name in (
        "R_eye_outer", "R_eye_inner", "L_eye_inner", "L_eye_outer", "nose_bridge_1",
        "nose_bridge_2", "nose_bridge_4", "nose_tip", "subnasale", "R_nostril_base",
        "L_nostril_base",
    )
)  # fmt: skip


def landmark_rows(n_landmarks: int) -> I32:
    """Return which of the 75 landmarks are fitted, the outline last.

    They are in the order of the face's features: what a coefficient moves is then together.

    Args:
        n_landmarks: 68 or 75.

    Raises:
        ValueError: Another number.
    """
    if n_landmarks not in (68, N_LANDMARKS):
        raise ValueError(f"68 or {N_LANDMARKS} landmarks can be fitted, not {n_landmarks}")
    ordered = dict.fromkeys(row for rows in GROUPS.values() for row in rows)
    every = n_landmarks == N_LANDMARKS
    kept = [
        row for row in ordered
        if every or row >= N_INTERNAL or TO_IBUG68[row] >= 0 or row in _WINGS
    ]  # fmt: skip
    return np.array(kept, np.int32)


@dataclass(frozen=True, slots=True, eq=False)
class SolverFace:
    """What is kept for one face.

    Attributes:
        tables: For the kernels; the columns of the outline change while tracking.
        rows: (L,) which of the 75 landmarks are fitted.
        shape_neutral: (3, 75) internal landmarks and replacement points.
        shape_deltas: (B, 3, 75).
    """

    tables: FaceTables
    rows: I32
    shape_neutral: FloatArray
    shape_deltas: FloatArray


def solver_face(face: Face, rows: I32) -> SolverFace:
    """Return the tables of a face.

    Args:
        face: The face at the points of a fit.
        rows: (L,) the fitted landmarks, the 15 of the outline last.
    """
    neutral = np.ascontiguousarray(face.neutral_mm.T)
    deltas = np.ascontiguousarray(np.moveaxis(face.deltas_mm, 1, 2))
    deltas[
        np.broadcast_to(np.abs(deltas).max(axis=1, keepdims=True), deltas.shape) < _NO_MOTION_MM
    ] = 0.0
    present = face.strips >= 0
    along = face.strips[present]
    starts = np.concatenate([[0], np.cumsum(present.sum(axis=1))])
    fixed = fixed_points(face.neutral_mm, face.strips)
    places = [
        int(starts[s] + np.flatnonzero(strip == point)[0])
        for s, (strip, point) in enumerate(zip(face.strips, fixed, strict=True))
    ]
    internal = rows[: -len(face.strips)]
    columns = np.concatenate([internal, fixed])
    tables = FaceTables(
        neutral=np.ascontiguousarray(neutral[:, columns]),
        deltas=np.ascontiguousarray(deltas[:, :, columns]),
        strip_neutral=np.ascontiguousarray(neutral[:, along]),
        strip_deltas=np.ascontiguousarray(deltas[:, :, along]),
        strip_starts=starts.astype(np.int32),
        fixed=np.array(places, np.int32),
        outward=outward_directions(face.neutral_mm, face.strips),
        picks=np.full(len(face.strips), -1, np.int32),
    )
    shape = np.concatenate([np.arange(N_INTERNAL), face.replacements])
    return SolverFace(
        tables, rows, np.ascontiguousarray(neutral[:, shape]),
        np.ascontiguousarray(deltas[:, :, shape]),
    )  # fmt: skip


def workspace_for(tables: FaceTables) -> Workspace:
    """Return memory for solving frames of a face."""
    n_landmarks, n_shapes = tables.neutral.shape[1], len(tables.deltas)
    n = N_POSE + n_shapes
    return Workspace(
        shape=np.zeros((3, n_landmarks)),
        strips=np.zeros(tables.strip_neutral.shape),
        lift=np.zeros((3, 2, n_landmarks)),
        root=np.zeros(n_landmarks),
        residual=np.zeros((2, n_landmarks)),
        jacobian=np.zeros((n, 2, n_landmarks)),
        hessian=np.zeros((n, n)),
        gradient=np.zeros(n),
        factor=np.zeros((n, n)),
        step=np.zeros(n),
        trial=np.zeros(n_shapes),
        pose=np.zeros((4, 3)),
    )
