"""All stages of a regressor, one after another, without a return to Python between them."""

from typing import NamedTuple

import numba

from core.kernels.appearance import Room, read_appearance
from core.kernels.ferns import add_leaves, choose_leaves, take_steps
from core.records import F32, I8, I16, I32, U8


class Stages(NamedTuple):
    """The arrays of core.fern_regressor that a frame needs, stage by stage."""

    corners: I32  # (T, P, 3)
    weights: F32  # (T, P, 3)
    offsets: F32  # (T, P, 3) mm
    members: I32  # (T, C, n)
    cell: I32  # (T, P)
    pairs: I32  # (T, K, F, 2)
    thresholds: F32  # (T, K, F)
    leaves: I8  # (T, K, 2**F, D)
    basis: F32  # (T, D, 3 Q) mm


class FernRoom(NamedTuple):
    """Work space for the ferns of one stage."""

    intensities: F32  # (P, R)
    leaf: I32  # (K, R)
    short: I16  # (L, D)
    taken: I32  # (L, D)


@numba.njit(cache=True, nogil=True)
def run_stages(
    image: U8,  # (H, W)
    stages: Stages,
    softening: float,
    rotation: F32,  # (3, 3) shape space to camera
    translation: F32,  # (3,) mm
    projection: F32,  # (3,)
    room: Room,
    ferns: FernRoom,
    shapes: F32,  # (R, Q, 3) mm, the first L are moved
) -> None:
    """Move L shapes through all stages [Cao13, algorithm 2]."""
    flat = shapes.reshape(shapes.shape[0], shapes.shape[1] * 3)
    for t in range(stages.pairs.shape[0]):
        read_appearance(
            image,
            shapes,
            rotation,
            translation,
            projection,
            stages.corners[t],
            stages.weights[t],
            stages.offsets[t],
            stages.members[t],
            stages.cell[t],
            softening,
            room,
            ferns.intensities,
        )
        choose_leaves(ferns.intensities, stages.pairs[t], stages.thresholds[t], ferns.leaf)
        add_leaves(stages.leaves[t], ferns.leaf, ferns.short, ferns.taken)
        take_steps(ferns.taken, stages.basis[t], flat)
