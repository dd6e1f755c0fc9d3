"""Juno: a cartoon human with large eyes, a small nose and hair in a few clean shapes."""

import numpy as np

from app.avatars.build import Head, Worn
from app.avatars.characters import Character, gradient_texture
from app.avatars.drawn_eyes import DrawnEye
from app.avatars.looks import Looks
from app.avatars.pieces import Clump, clump, joined
from app.avatars.warp import EyeStyle, Push, Swell
from app.render.scene import Material

_STEPS = (
    Swell((0, -30, 75), (105, 85, 110), (1.16, 1.13, 1.10)),
    Swell((0, 82, -5), (75, 52, 85), (0.80, 0.80, 0.92)),
    Swell((0, 105, 30), (95, 45, 90), (0.78, 0.95, 0.95)),
    Push((0, 40, -44), (20, 22, 26), (0, -4, 14)),
    Swell((0, 36, -32), (20, 26, 40), (0.78, 0.85, 0.7)),
    Swell((0, 70, -24), (40, 13, 30), (1.0, 0.74, 1.0)),
    Push((19, 70, -18), (11, 10, 16), (3, -3, 2)),
    Swell((0, 150, 95), (200, 48, 200), (0.72, 1.0, 0.75)),
    Push((46, 50, -8), (26, 24, 30), (5, 0, -5)),
)
_EYES = EyeStyle(size=1.42, shift=(7.5, 6.0, 6.0), tall=0.19, slant_rad=0.05, inner=1.2, outer=3.4)
#: Locks over the forehead, at the temples and at the nape; the parting is on the left.
_LOCKS = (
    Clump(((30, 72, 15), (6, 44, 30), (-26, 8, 9)), 46),
    Clump(((30, 72, 15), (-6, 50, 32), (-50, 14, 11)), 50),
    Clump(((30, 72, 15), (-24, 56, 30), (-70, 6, 10)), 50),
    Clump(((30, 72, 15), (34, 42, 27), (22, 12, 8)), 36),
    Clump(((30, 72, 15), (52, 46, 28), (50, 10, 9)), 46),
    Clump(((30, 72, 15), (66, 52, 27), (72, 4, 10)), 46),
    Clump(((-64, 40, 12), (-80, 10, 24), (-68, -26, 7)), 40),
    Clump(((64, 40, 12), (80, 10, 24), (68, -26, 7)), 40),
    Clump(((34, 78, 16), (0, 104, 38), (-26, 98, 44)), 24, 0.7),
    Clump(((-96, 30, 10), (-108, 0, 30), (-110, -40, 18)), 52),
    Clump(((96, 30, 10), (108, 0, 30), (110, -40, 18)), 52),
    Clump(((-132, 30, 10), (-140, -4, 32), (-142, -48, 18)), 58),
    Clump(((132, 30, 10), (140, -4, 32), (142, -48, 18)), 58),
    Clump(((180, 30, 10), (180, -6, 32), (180, -52, 18)), 60),
)


def _hair() -> Material:
    texture = gradient_texture((38, 104, 120), (38, 104, 120), 0.05)
    return Material("hair", texture, {"shine": 0.35}, two_sided=True, repeated=True)


def _worn(head: Head) -> tuple[Worn, ...]:
    skin = head.neutral_mm[np.unique(head.model.triangles[head.model.part_triangles("skin")])]
    texture = gradient_texture((34, 94, 112), (78, 168, 166))
    locks = joined([clump(shape, skin) for shape in _LOCKS])
    return (Worn(Material("hair", texture, {"shine": 0.35}), locks),)


JUNO = Character(
    likeness=0.6,
    person="nora",
    steps=_STEPS,
    eyes=_EYES,
    even=14,
    looks=Looks(lashes=1.0, hair_style="short", shirt=(232, 176, 60)),
    eye=DrawnEye((74, 148, 84), iris_rad=0.52, pupil=0.5),
    oily=0.16,
    worn=_worn,
    strengths={"browInnerUp": 1.4, "browOuterUp": 0.75},
    hair=_hair,
)
