"""The few vertices that a fit looks at, and the face they form at one identity."""

from dataclasses import dataclass

import numpy as np

from core.face_model import FaceModel, subset
from core.landmarks import N_INTERNAL
from core.records import I32, FloatArray, UserBlendshapes


@dataclass(frozen=True, slots=True, eq=False)
class FitSpace:
    """The model at the internal landmarks, the contour strips and the replacement points.

    Attributes:
        vertices: (P,) model vertex of each point; the internal landmarks come first.
        strips: (15, W) points of each contour strip from the front to the back, -1 padded.
        replacements: (15,) points that stand in for the contour [Cao13, sec. 3].
        mean_mm: (P, 3).
        identity_modes_mm: (P, 3, I).
        delta_modes_mm: (B, P, 3, I + 1) blendshape deltas: constant, then per identity mode.
    """

    vertices: I32
    strips: I32
    replacements: I32
    mean_mm: FloatArray
    identity_modes_mm: FloatArray
    delta_modes_mm: FloatArray

    @property
    def n_identities(self) -> int:
        """Return I, the number of identity weights."""
        return int(self.identity_modes_mm.shape[-1])

    def face(self, identity: FloatArray, offsets_mm: FloatArray) -> "Face":
        """Return the face with this identity.

        Args:
            identity: (I,).
            offsets_mm: (60, 3) displacement of the internal landmarks from the model.
        """
        neutral = self.mean_mm + self.identity_modes_mm @ identity
        neutral[:N_INTERNAL] += offsets_mm
        deltas = self.delta_modes_mm @ np.concatenate([[1.0], identity])
        return Face(neutral, deltas, self.strips, self.replacements)

    def narrowed(self, picks: I32) -> tuple["FitSpace", I32]:
        """Return the space of the picked points only, and the picks counted in it.

        Args:
            picks: (N, L) points.
        """
        used, renumbered = np.unique(picks, return_inverse=True)
        space = FitSpace(
            self.vertices[used], self.strips, self.replacements, self.mean_mm[used],
            self.identity_modes_mm[used], self.delta_modes_mm[:, used],
        )  # fmt: skip
        return space, renumbered.reshape(picks.shape).astype(np.int32)

    def identity_jacobians(self, expressions: FloatArray, picks: I32) -> FloatArray:
        """Return d(picked points)/d(identity), (N, L, 3, I) in mm, at expressions (N, B)."""
        n_shapes, n_points, _, n_weights = self.delta_modes_mm.shape
        # The constant term is multiplied, too: leaving it out would copy all the modes.
        bent = expressions @ self.delta_modes_mm.reshape(n_shapes, -1)
        modes = bent.reshape(-1, n_points, 3, n_weights)[..., 1:] + self.identity_modes_mm
        return np.asarray(modes[np.arange(len(picks))[:, None], picks])


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """One person's face at the points of a fit.

    Attributes:
        neutral_mm: (P, 3) in the model frame.
        deltas_mm: (B, P, 3).
        strips: (15, W) see FitSpace.
        replacements: (15,) see FitSpace.
    """

    neutral_mm: FloatArray
    deltas_mm: FloatArray
    strips: I32
    replacements: I32

    def points_mm(self, expressions: FloatArray) -> FloatArray:
        """Return the points (N, P, 3) in the model frame at expressions (N, B)."""
        flat = expressions @ self.deltas_mm.reshape(len(self.deltas_mm), -1)
        return np.asarray(self.neutral_mm + flat.reshape(len(expressions), -1, 3))


def fit_space(model: FaceModel) -> FitSpace:
    """Return the model at the points that the fits need."""
    vertices, strips, replacements = fit_vertices(model)
    dense = subset(model, vertices)
    identity = np.ascontiguousarray(np.moveaxis(dense.identity, 0, -1))
    deltas = np.ascontiguousarray(np.moveaxis(dense.deltas, 1, -1))
    return FitSpace(vertices, strips, replacements, dense.mean, identity, deltas)


def fit_vertices(model: FaceModel) -> tuple[I32, I32, I32]:
    """Return model vertices (P,), strips (15, W) and replacements (15,) as points among them."""
    strip_vertices = np.asarray(model.contour_strips)
    along = strip_vertices[strip_vertices >= 0]
    others = np.unique(np.concatenate([along, model.replacement_vertices]))
    vertices = np.concatenate([model.landmark_vertices, others]).astype(np.int32)
    strips = np.full(strip_vertices.shape, -1, np.int32)
    strips[strip_vertices >= 0] = N_INTERNAL + np.searchsorted(others, along)
    replacements = N_INTERNAL + np.searchsorted(others, model.replacement_vertices)
    return vertices, strips, replacements.astype(np.int32)


def face_at(model: FaceModel, user: UserBlendshapes) -> Face:
    """Return the face of a user's blendshapes at the points of a fit."""
    vertices, strips, replacements = fit_vertices(model)
    neutral = user.neutral_mm[vertices]
    neutral[:N_INTERNAL] += user.landmark_offsets_mm
    return Face(neutral, user.deltas_mm[:, vertices].astype(np.float64), strips, replacements)
