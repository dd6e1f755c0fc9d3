"""What all pictures of one user are laid on: texels, masks, the head in each picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from app.avatars.hairline import above_hairline_mm
from app.avatars.likeness.atlas import Atlas, make_atlas
from app.avatars.likeness.surroundings import Surroundings
from app.avatars.likeness.views import Posed, posed
from core.face_model import FaceModel
from core.records import (
    F32,
    U8,
    BoolArray,
    Camera,
    FloatArray,
    Landmarks2D,
    SetupShapes,
    UserBlendshapes,
)

#: Texels along each side of the texture.
SIZE_PX = 1536
#: Painted maps that say where on the face a texel lies.
_MAPS = ("lips", "lids", "brows", "flesh", "lashline", "scalp")
#: Hair may hang over skin that lies less than this below the hairline.
_FRINGE_MM = 28.0


@dataclass(frozen=True, slots=True, eq=False)
class Pictures:
    """What a likeness is made from.

    Attributes:
        images: N setup pictures (H, W, 3).
        landmarks: Theirs.
        shapes: The 3D shape of each.
        camera: Theirs.
        user: Whose.
    """

    images: Sequence[U8]
    landmarks: Sequence[Landmarks2D]
    shapes: SetupShapes
    camera: Camera
    user: UserBlendshapes

    def head(self, model: FaceModel, row: int) -> Posed:
        """Return the user's head in one picture."""
        return posed(model, self.user, self.shapes, self.landmarks[row], self.camera, row)


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What all pictures are laid on.

    Attributes:
        model: Topology.
        atlas: Texels of the skin inside the window.
        mesh: The skin as a net.
        maps: (X,) of some painted maps.
        window: (X,) where pictures may be shown.
        near_hair: (X,) 1 where hair may hang over the skin.
        plain: (X,) skin without lips, brows, lids and hair.
        face_vertices: (V,) vertices of the skin inside the window.
    """

    model: FaceModel
    atlas: Atlas
    mesh: Surroundings
    maps: dict[str, F32]
    window: F32
    near_hair: F32
    plain: BoolArray
    face_vertices: BoolArray


def lay_ground(model: FaceModel, skin_maps: Path) -> Ground:
    """Return the ground of a face model; `skin_maps` is assets/textures/skin."""
    mean = model.mean_mm.astype(float)
    opened = window(mean)
    atlas = make_atlas(model, SIZE_PX, opened > 0)
    maps = {name: atlas.gathered(_map(skin_maps / f"{name}.jpg")) for name in _MAPS}
    shown = atlas.at_texels(opened)
    hairline = above_hairline_mm(mean)
    near = atlas.at_texels(np.clip((hairline + _FRINGE_MM) / 8, 0, 1))
    painted = np.max([maps[name] for name in _MAPS], axis=0)
    skin = np.zeros(len(mean), bool)
    skin[np.unique(model.triangles[model.part_triangles("skin")])] = True
    return Ground(
        model,
        atlas,
        Surroundings(model),
        maps,
        shown,
        near,
        (painted < 0.12) & (shown > 0.5),
        skin & (opened > 0.5),
    )


def _map(path: Path) -> F32:
    """Return a painted map (S, S) in [0, 1]."""
    picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if picture is None:
        raise FileNotFoundError(f"{path} is damaged: install facepuppet again")
    fitted = cv2.resize(picture, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_LINEAR)
    return np.asarray(fitted / np.float32(255), np.float32)


def window(mean_mm: FloatArray) -> FloatArray:
    """Return (V,) 1 on the face of the mean head (V, 3), 0 at ears, neck and below the hair."""
    x, y, z = np.moveaxis(np.asarray(mean_mm, float), -1, 0)
    side = np.rad2deg(np.arctan2(np.abs(x), 78.0 - z))
    front = np.clip((66 - side) / 10, 0, 1)
    # Under the chin the light is bad and the fit coarse.
    chin = np.clip((113 + 0.22 * (z + 25) - y) / 10, 0, 1)
    return np.asarray(front * chin * np.clip((72 - z) / 15, 0, 1))
