"""Make assets/animation_prior.npz: the Gaussian mixtures over coefficients and their history.

Recipe. About 15 minutes of animation at 30 frames a second are generated from a fixed seed:
still faces with small drifts, speech as chains of visemes with co-articulation, lively speech with
brow accents and emotions, emotions and grimaces with onset, apex and offset, winks, and random
combinations of one to four of all 46 shapes; spontaneous blinks over all but the winks. Both
sides move alike but not equally, and every clip is also taken mirrored. A sample is a frame and
its three predecessors. The predecessors carry noise as the tracker's own past results will, of
several strengths and correlated over time; without it the mixture would extrapolate from clean
differences and amplify noise. Each region of the face gets its own mixture (see
core/animation_prior.py) by expectation maximisation.

Run: PYTHONPATH=. python assets/build/animation_prior.py [assets/animation_prior.npz]
"""

import sys
from pathlib import Path

import numpy as np

from assets.build.animation_mixture import MixtureSettings, fit_mixture
from assets.build.animation_script import FRAME_S, performance
from core.animation_prior import (
    N_LAGS,
    REGIONS,
    AnimationPrior,
    RegionMixture,
    members,
    save_animation_prior,
)
from core.arkit import mirror_permutation
from core.records import FloatArray

SEED = 20
MINUTES = 15.0
#: Standard deviation of the past results' noise, one drawn for each clip.
NOISE_LEVELS = (0.005, 0.01, 0.03)
NOISE_CORRELATION = 0.5
COMPONENTS = 8


def noise(rng: np.random.Generator, shape: tuple[int, int]) -> FloatArray:
    """Return noise (N, B) correlated from frame to frame."""
    out = rng.choice(NOISE_LEVELS) * rng.standard_normal(shape)
    for row in range(1, shape[0]):
        out[row] = NOISE_CORRELATION * out[row - 1] + np.sqrt(1 - NOISE_CORRELATION**2) * out[row]
    return out


def samples_of(rng: np.random.Generator, clip: FloatArray) -> FloatArray:
    """Return (N - N_LAGS, 1 + N_LAGS, B): each frame, then its noisy predecessors."""
    noisy = np.clip(clip + noise(rng, clip.shape), 0.0, 1.0)
    frames = [clip[N_LAGS:]]
    frames += [noisy[N_LAGS - lag : -lag] for lag in range(1, N_LAGS + 1)]
    return np.stack(frames, axis=1)


def make_prior() -> AnimationPrior:
    """Generate the animation and fit the mixtures."""
    rng = np.random.default_rng(SEED)
    clips = performance(rng, MINUTES)
    mirrored = [clip[:, mirror_permutation()] for clip in clips]
    samples = np.concatenate([samples_of(rng, clip) for clip in clips + mirrored])
    print(f"{len(clips)} clips, {samples.shape[0]} samples with their mirror images")
    regions = []
    for name in REGIONS:
        chosen = members(name)
        values = samples[:, :, chosen].reshape(samples.shape[0], -1)
        mixture, level = fit_mixture(rng, values, chosen.size, MixtureSettings(COMPONENTS))
        weights = np.array2string(mixture.weights, precision=3)
        print(f"{name}: log likelihood {level:.2f} per sample, weights {weights}")
        regions.append(RegionMixture(chosen, mixture.weights, mixture.means, mixture.covariances))
    return AnimationPrior(FRAME_S, tuple(regions))


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "assets/animation_prior.npz")
    save_animation_prior(target, make_prior())
    print(f"{target}: {target.stat().st_size / 1024:.0f} KiB")
