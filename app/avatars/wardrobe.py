"""What all avatars share, read from the shipped files."""

from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from app.avatars.bust import Bust, load_bust
from app.avatars.hair import Scalp, scalp_of
from app.avatars.head import holds, inner_shade
from app.avatars.mouth import bright_teeth, lip_seal
from app.errors import AppError
from app.render.lip_seal import LipSeal
from core.face_model import FaceModel
from core.records import F32, U8


class AvatarFileError(AppError):
    """A file that avatars are made from is missing, damaged or of another version."""

    def __init__(self, path: Path, found: str) -> None:
        self.path, self.found = path, found
        super().__init__(
            f"{path}: found {found}, expected the avatar files of this version: "
            "install facepuppet again"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Wardrobe:
    """What all avatars share.

    Attributes:
        skin_maps: Folder of the skin's maps.
        mouth: (S, S, 3) texture of teeth and tongue.
        lashes: (S, S) coverage of the lashes.
        extra: (V, 4) hold and openness of the face model's vertices, see `Mesh`.
        scalp: Where hair grows.
        bust: Neck and shirt.
        seal: Draws lips together that nearly touch; None: they are shown as they are.
        wetness: Strength of the highlights on teeth and tongue.
        fray_mm: How far below the hairline hair begins; over painted roots it looks soft.
    """

    skin_maps: Path
    mouth: U8
    lashes: U8
    extra: F32
    scalp: Scalp
    bust: Bust
    seal: LipSeal | None = None
    wetness: float = 0.9
    fray_mm: float = 2.0


def load_wardrobe(assets: Path, model: FaceModel) -> Wardrobe:
    """Return what all avatars of a face model share.

    Args:
        assets: The folder of shipped files; app.resources.asset(".").
        model: The shipped face model.

    Raises:
        AvatarFileError: A file cannot be used.
    """
    extra = np.ones((len(model.mean_mm), 4), np.float32)
    extra[:, 0] = holds(model)
    openness = _openness(assets / "avatars" / "openness.npz", len(extra))
    inside, shade = inner_shade(model)
    # Measured on a shut mouth, the openness says nothing about the inside of an open one.
    extra[:, 1] = np.where(inside, shade, openness)
    return Wardrobe(
        assets / "textures" / "skin",
        _picture(assets / "textures" / "mouth.jpg"),
        np.ascontiguousarray(_picture(assets / "textures" / "lashes.jpg")[..., 1]),
        extra,
        scalp_of(model),
        load_bust(assets / "performer" / "body.npz"),
    )


def embellished(wardrobe: Wardrobe, model: FaceModel) -> Wardrobe:
    """Return the wardrobe of avatars to be seen: bright teeth, and lips that meet."""
    return replace(
        wardrobe, mouth=bright_teeth(wardrobe.mouth), seal=lip_seal(model), wetness=0.3, fray_mm=6.0
    )


def _openness(path: Path, n: int) -> F32:
    try:
        with np.load(path, allow_pickle=False) as data:
            openness = data["openness"].astype(np.float32) / 255
    except (OSError, KeyError, ValueError) as error:
        raise AvatarFileError(path, str(error)) from error
    if len(openness) != n:
        raise AvatarFileError(path, f"{len(openness)} vertices where the face model has {n}")
    return np.asarray(openness)


def _picture(path: Path) -> U8:
    """Return an RGB picture."""
    picture = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if picture is None:
        raise AvatarFileError(path, "no picture")
    return np.ascontiguousarray(picture[..., ::-1])
