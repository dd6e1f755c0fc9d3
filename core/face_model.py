"""The bilinear face model: vertices from identity and expression [Cao13, sec. 3].

F(w, a) = N(w) + sum_b a_b D_b(w). Cao's core tensor is stored factored: the neutral face N(w) is
the mean plus identity modes, and every expression's displacement D_b(w), linear in (1, w), is a
mix of common displacement modes. Identity weights are in standard deviations, so their prior is
N(0, 1) around the mean face. Frame: x to the subject's left, y down, z into the head, mm, origin
between the eyeball centres.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.errors import CoreError
from core.records import F32, I32, U8, FloatArray, freeze

PART_NAMES = ("skin", "mouth", "eye_right", "eye_left", "teeth", "tongue", "lashes")
N_EXPRESSIONS = len(EXPRESSION_NAMES)


class FaceModelFileError(CoreError):
    """The file of the face model is not one that this program can use."""

    def __init__(self, path: Path, found: str) -> None:
        self.path, self.found = path, found
        super().__init__(
            f"{path}: found {found}, expected the face model of this version; "
            "reinstall, or build it again with python -m assets.build.face_model"
        )


@dataclass(frozen=True, slots=True, eq=False)
class FaceModel:
    """The shapes of many people's faces in many expressions.

    Attributes:
        mean_mm: (V, 3) neutral face of the mean identity, mirror-symmetric.
        identity_modes_mm: (I, V, 3) change of the neutral face per standard deviation.
        delta_modes_mm: (M, V, 3) common displacement modes P.
        delta_coefficients: (B, I+1, M) mix of the modes for (1, w).
        triangles: (T, 3); triangles 2k and 2k+1 are quad k: (a, b, c) and (a, c, d).
        part: (T,) index into PART_NAMES.
        uv: (T, 3, 2) texture coordinates of each corner, u right, v down. Skin and mouth share
            one texture, teeth and tongue another; each eye and the lashes have their own.
        landmark_vertices: (60,) vertices of the internal landmarks.
        replacement_vertices: (15,) inner vertices that stand for the contour landmarks.
        contour_strips: (15, W) vertices that each contour landmark slides along, -1 = no more.
        eyeball_vertices_right: Vertices of the subject's right eyeball.
        eyeball_vertices_left: Vertices of the subject's left eyeball.
        eye_center_vertices: (2,) vertices in no triangle: eyeball centres, right then left.
        eyeball_radius_mm: Radius of the mean identity's eyeballs.
        mirror_vertices: (V,) the vertex on the other side.
        identity_mirror: (I,) 1 or -1: mirroring a face multiplies its weights by this.
    """

    mean_mm: F32
    identity_modes_mm: F32
    delta_modes_mm: F32
    delta_coefficients: F32
    triangles: I32
    part: U8
    uv: F32
    landmark_vertices: I32
    replacement_vertices: I32
    contour_strips: I32
    eyeball_vertices_right: I32
    eyeball_vertices_left: I32
    eye_center_vertices: I32
    eyeball_radius_mm: float
    mirror_vertices: I32
    identity_mirror: F32

    def __post_init__(self) -> None:
        freeze(
            self,
            mean_mm=(np.float32, ("V", 3)),
            identity_modes_mm=(np.float32, ("I", "V", 3)),
            delta_modes_mm=(np.float32, ("M", "V", 3)),
            delta_coefficients=(np.float32, (N_EXPRESSIONS, "I+1", "M")),
            triangles=(np.int32, ("T", 3)),
            part=(np.uint8, ("T",)),
            uv=(np.float32, ("T", 3, 2)),
            landmark_vertices=(np.int32, (60,)),
            replacement_vertices=(np.int32, (15,)),
            contour_strips=(np.int32, (15, "W")),
            eyeball_vertices_right=(np.int32, ("E",)),
            eyeball_vertices_left=(np.int32, ("E",)),
            eye_center_vertices=(np.int32, (2,)),
            mirror_vertices=(np.int32, ("V",)),
            identity_mirror=(np.float32, ("I",)),
        )

    @property
    def n_identities(self) -> int:
        """Return I, the number of identity weights."""
        return len(self.identity_modes_mm)

    @property
    def quads(self) -> I32:
        """Return (T/2, 4) the faces before they were cut into triangles."""
        return np.concatenate([self.triangles[::2], self.triangles[1::2, 2:]], axis=1)

    def part_triangles(self, name: str) -> I32:
        """Return the numbers of the triangles of one part."""
        return np.flatnonzero(self.part == PART_NAMES.index(name)).astype(np.int32)


@dataclass(frozen=True, slots=True, eq=False)
class Subset:
    """Some vertices of the model, contracted for fitting.

    Attributes:
        mean: (n, 3) mm.
        identity: (I, n, 3) mm per standard deviation.
        deltas: (B, I+1, n, 3) mm, displacement of each expression for (1, w).
    """

    mean: FloatArray
    identity: FloatArray
    deltas: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            mean=(np.float64, ("n", 3)),
            identity=(np.float64, ("I", "n", 3)),
            deltas=(np.float64, ("B", "I+1", "n", 3)),
        )

    def points(self, identity: FloatArray, expression: FloatArray) -> FloatArray:
        """Return the vertices (n, 3) mm of identity weights (I,) and expression (B,)."""
        return np.asarray(
            self.mean
            + np.tensordot(identity, self.identity, axes=1)
            + np.tensordot(expression, self.expression_deltas(identity), axes=1)
        )

    def expression_deltas(self, identity: FloatArray) -> FloatArray:
        """Return each expression's displacement (B, n, 3) mm for one identity."""
        weights = np.concatenate([[1.0], identity])
        return np.asarray(np.tensordot(weights, self.deltas, axes=(0, 1)))

    def identity_jacobian(self, expression: FloatArray) -> FloatArray:
        """Return d points / d identity, (n, 3, I)."""
        change = self.identity + np.tensordot(expression, self.deltas[:, 1:], axes=1)
        return np.moveaxis(change, 0, -1)

    def expression_jacobian(self, identity: FloatArray) -> FloatArray:
        """Return d points / d expression, (n, 3, B)."""
        return np.moveaxis(self.expression_deltas(identity), 0, -1)


def load_face_model(path: Path) -> FaceModel:
    """Return the face model in a file.

    Args:
        path: The npz file; app.resources.asset("face_model.npz") in a checkout or installation.

    Raises:
        FaceModelFileError: The file is missing, broken or of another version.
    """
    try:
        with np.load(path, allow_pickle=False) as data:
            names = tuple(str(name) for name in data["expression_names"])
            arrays = {name: data[name] for name in FaceModel.__dataclass_fields__}
    except (OSError, KeyError, ValueError) as error:
        raise FaceModelFileError(path, str(error)) from error
    if names != EXPRESSION_NAMES:
        raise FaceModelFileError(path, "other expression names")
    arrays["eyeball_radius_mm"] = float(arrays["eyeball_radius_mm"])
    arrays["uv"] = arrays["uv"].astype(np.float32) / np.iinfo(np.uint16).max
    return FaceModel(**arrays)


def neutral_mm(model: FaceModel, identity: FloatArray) -> FloatArray:
    """Return the neutral face N(w), (V, 3) mm, of identity weights (I,)."""
    weights = np.asarray(identity, np.float32)
    return np.asarray(
        model.mean_mm + np.tensordot(weights, model.identity_modes_mm, axes=1), dtype=np.float64
    )


def deltas_mm(model: FaceModel, identity: FloatArray) -> F32:
    """Return each expression's displacement D_b(w), (B, V, 3) mm, of identity weights (I,)."""
    weights = np.concatenate([[1.0], identity]).astype(np.float32)
    mix = np.tensordot(weights, model.delta_coefficients, axes=(0, 1))
    return np.tensordot(mix, model.delta_modes_mm, axes=1)


def vertices_mm(model: FaceModel, identity: FloatArray, expression: FloatArray) -> FloatArray:
    """Return the face F(w, a), (V, 3) mm, of identity weights (I,) and expression (B,)."""
    weights = np.concatenate([[1.0], identity])
    mix = np.einsum("b,i,bim->m", expression, weights, model.delta_coefficients)
    moved = np.tensordot(mix.astype(np.float32), model.delta_modes_mm, axes=1)
    return neutral_mm(model, identity) + moved


def eye_centers_mm(model: FaceModel, neutral: FloatArray) -> FloatArray:
    """Return the eyeball centres (2, 3), right then left, of a face (V, 3) of the model."""
    return np.asarray(neutral)[model.eye_center_vertices]


def shape_vertices(model: FaceModel) -> I32:
    """Return the (75,) vertices of the internal landmarks and the 15 replacements."""
    return np.concatenate([model.landmark_vertices, model.replacement_vertices])


def subset(model: FaceModel, vertices: I32) -> Subset:
    """Return the model at some vertices (n,), dense, for fitting."""
    modes = model.delta_modes_mm[:, vertices].astype(np.float64)
    return Subset(
        model.mean_mm[vertices].astype(np.float64),
        model.identity_modes_mm[:, vertices].astype(np.float64),
        np.tensordot(model.delta_coefficients.astype(np.float64), modes, axes=1),
    )
