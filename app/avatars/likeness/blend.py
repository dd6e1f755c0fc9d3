"""Joins what the pictures show into one texture, and painted skin where none shows anything.

What takes long is a generator that stops now and then, so that it can be given up.
"""

from collections.abc import Generator, Sequence

import cv2
import numpy as np

from app.avatars.likeness.atlas import Atlas
from app.avatars.likeness.ground import Ground
from app.avatars.likeness.surroundings import at_vertices
from core.records import F32, FloatArray

#: Width of the blur that parts coarse from fine, in texels of a texture of 1024.
_COARSE = 9.0
#: Fine detail comes from the picture that sees best: power of the weights.
_SHARP = 5
#: A picture may not differ from the others by more than this, as a logarithm.
_MOST_OFF = 0.5
#: Share of a small smooth difference in brightness that is kept.
_KEPT = 0.3
#: What is this much brighter or darker than in the other pictures is not skin, as a logarithm.
_BRIGHTER, _DARKER = 0.16, 0.30
#: Width over which trust in a picture changes, in texels.
_SOFT = 20.0
#: Trust that stays: who sees a place from the side does not know it better.
_FLOOR = 0.06
#: How often the pictures' mean is taken anew from those that agree.
_AGREEING = 2


def agreeing(
    ground: Ground, albedos: Sequence[F32], weights: Sequence[F32]
) -> Generator[None, None, list[F32]]:
    """Return the pictures' albedos (X, 3), brought to what they say in common.

    What the light's model leaves is smooth: each picture is multiplied by a smooth function on
    the head that takes it to the mean of all. No edge stays where one picture ends.
    """
    logs = [np.log(np.maximum(albedo, 2e-3)) for albedo in albedos]
    total = np.maximum(np.sum(weights, axis=0), 1e-6)
    mean = np.sum([w[:, None] * log for w, log in zip(weights, logs, strict=True)], axis=0)
    mean = (mean / total[:, None]).astype(np.float32)
    yield
    out = []
    for albedo, log, weight in zip(albedos, logs, weights, strict=True):
        off, trust = at_vertices(ground.atlas, mean - log, weight)
        smooth = ground.mesh.extended(np.clip(off, -_MOST_OFF, _MOST_OFF), 0.02 * trust)
        out.append(albedo * np.exp(ground.atlas.at_texels(smooth)))
        yield
    return out


def agreed_weights(
    albedos: Sequence[F32], weights: Sequence[F32], atlas: Atlas
) -> Generator[None, None, list[F32]]:
    """Return weights (X,) that trust no texel which looks otherwise than in most pictures.

    Highlights wander over the skin when the head turns, and what stands before the skin, as the
    frame of glasses does, hides another part of it.
    """
    logs = np.log(np.stack([np.maximum(a.mean(axis=1), 2e-3) for a in albedos]))
    first = np.stack(weights)
    trust = np.ones_like(first)
    for _ in range(_AGREEING):
        yield
        now = trust * first
        mean = (now * logs).sum(axis=0) / np.maximum(now.sum(axis=0), 1e-6)
        off = logs - mean
        trust = np.exp(-np.square(off / np.where(off > 0, _BRIGHTER, _DARKER)))
    # Where two pictures disagree, which of them is believed must not change from texel to texel.
    out = []
    for share, weight in zip(trust.astype(np.float32), weights, strict=True):
        soft = blurred(share[:, None], weight, atlas, _SOFT)[:, 0]
        out.append(np.asarray(weight * (_FLOOR + (1 - _FLOOR) * soft), np.float32))
        yield
    return out


def joined(
    albedos: Sequence[F32], weights: Sequence[F32], atlas: Atlas
) -> Generator[None, None, F32]:
    """Return one albedo (X, 3): the coarse mean of all, the fine detail of the best."""
    width = _COARSE * atlas.size_px / 1024
    coarse_sum = np.zeros_like(albedos[0])
    fine_sum = np.zeros_like(albedos[0])
    coarse_total = np.full(len(albedos[0]), 1e-9, np.float32)
    fine_total = np.full(len(albedos[0]), 1e-9, np.float32)
    best = np.maximum(np.max(weights, axis=0), 1e-6)
    for albedo, weight in zip(albedos, weights, strict=True):
        coarse = blurred(albedo, weight, atlas, width)
        sharp = (weight / best) ** _SHARP * (weight > 1e-4)
        coarse_sum += weight[:, None] * coarse
        coarse_total += weight
        fine_sum += sharp[:, None] * (albedo - coarse)
        fine_total += sharp
        yield
    return np.asarray(
        coarse_sum / coarse_total[:, None] + fine_sum / fine_total[:, None], np.float32
    )


def blurred(values: F32, weight: F32, atlas: Atlas, width: float) -> F32:
    """Return values (X, C) blurred over the texels that have weight (X,)."""
    packed = atlas.spread(np.concatenate([values * weight[:, None], weight[:, None]], axis=1))
    last = atlas.rows.max() + 1
    # What is smooth needs few texels.
    small = cv2.resize(packed[:last], None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    small = cv2.GaussianBlur(small, (0, 0), width / 4)
    packed[:last] = cv2.resize(small, (len(packed), last), interpolation=cv2.INTER_LINEAR)
    soft = atlas.gathered(packed)
    return np.asarray(soft[:, :-1] / np.maximum(soft[:, -1:], 1e-6), np.float32)


def toning(ground: Ground, own: F32, painted: F32, share: F32) -> tuple[FloatArray, FloatArray]:
    """Return how own skin differs from painted skin, smoothly, as logarithms (V, 3), twice.

    First what is found, gone on with where nothing is known; then what is kept of it: small
    smooth differences are more often light that was not understood than paint of the skin. A
    beard or a birthmark is a large one.

    Args:
        ground: Of all.
        own: (X, 3) albedo from the pictures.
        painted: (X, 3) albedo of painted skin.
        share: (X,) how much of the own is shown.
    """
    off = np.log(np.maximum(own, 2e-3)) - np.log(np.maximum(painted, 2e-3))
    mean, trust = at_vertices(ground.atlas, off, share * ground.plain)
    center = np.average(mean, axis=0, weights=trust + 1e-9)
    found = ground.mesh.extended(center + np.clip(mean - center, -0.9, 0.9), 0.3 * trust)
    level = (found - center).mean(axis=1, keepdims=True)
    tint = found - center - level
    large = np.clip((np.abs(level) - 0.25) / 0.4, 0, 1)
    return found, center + level * (_KEPT + (1 - _KEPT) * large) + 0.6 * tint


def edge_padded(picture: F32, atlas: Atlas, rounds: int = 6) -> F32:
    """Return a texture (S, S, C) whose islands go on a little beyond their edges."""
    known = atlas.spread(np.ones(len(atlas.rows), np.float32))
    out = picture.copy()
    kernel = np.ones((3, 3), np.float32)
    for _ in range(rounds):
        around = cv2.filter2D(known, -1, kernel)
        total = cv2.filter2D(out * known[..., None], -1, kernel)
        fresh = (known == 0) & (around > 0)
        out[fresh] = total[fresh] / around[fresh][:, None]
        known[fresh] = 1
    return out
