"""Gaussian mixtures with full covariances by expectation maximisation, in numpy alone."""

from dataclasses import dataclass

import numpy as np

from core.records import FloatArray


@dataclass(frozen=True, slots=True)
class MixtureSettings:
    """How a mixture is fitted.

    Attributes:
        components: Fitted ones, without the broad one.
        rounds: Of expectation and maximisation.
        floor: Standard deviation added to every value.
        shrinkage: Samples' worth of the mean covariance mixed into each component's own.
        broad_weight: Weight of one fixed component that allows everything.
        broad_deviation: Its standard deviation.
    """

    components: int
    rounds: int = 25
    floor: float = 0.01
    shrinkage: float = 100.0
    broad_weight: float = 0.01
    broad_deviation: float = 0.3


@dataclass(frozen=True, slots=True)
class Mixture:
    """Weights (S,), means (S, K) and covariances (S, K, K)."""

    weights: FloatArray
    means: FloatArray
    covariances: FloatArray


def log_densities(mixture: Mixture, samples: FloatArray) -> FloatArray:
    """Return log(weight * density) of every component at every sample, (N, S)."""
    out = np.empty((samples.shape[0], mixture.weights.size))
    constant = samples.shape[1] * np.log(2 * np.pi)
    for s, covariance in enumerate(mixture.covariances):
        whitener = np.linalg.inv(np.linalg.cholesky(covariance))
        white = (samples - mixture.means[s]) @ whitener.T
        log_determinant = -2 * np.log(np.diag(whitener)).sum()
        squares = np.einsum("nk,nk->n", white, white)
        out[:, s] = np.log(mixture.weights[s]) - 0.5 * (squares + log_determinant + constant)
    return out


def expectation(mixture: Mixture, samples: FloatArray) -> tuple[FloatArray, float]:
    """Return the responsibilities (N, S) and the mean log likelihood."""
    logs = log_densities(mixture, samples)
    highest = logs.max(axis=1, keepdims=True)
    shares = np.exp(logs - highest)
    total = shares.sum(axis=1, keepdims=True)
    return shares / total, float((np.log(total) + highest).mean())


def maximisation(
    samples: FloatArray, shares: FloatArray, settings: MixtureSettings, broad: Mixture
) -> Mixture:
    """Return the mixture of weighted samples, its last component `broad`."""
    counts = shares[:, :-1].sum(axis=0) + 1e-9
    means = shares[:, :-1].T @ samples / counts[:, None]
    covariances = np.empty((counts.size, samples.shape[1], samples.shape[1]))
    for s in range(counts.size):
        spread = (samples - means[s]) * np.sqrt(shares[:, s, None])
        covariances[s] = spread.T @ spread
    pooled = covariances.sum(axis=0) / counts.sum()
    covariances = (covariances + settings.shrinkage * pooled) / (counts + settings.shrinkage)[
        :, None, None
    ]
    covariances += settings.floor**2 * np.eye(samples.shape[1])
    weights = (1 - settings.broad_weight) * counts / counts.sum()
    return Mixture(
        np.append(weights, settings.broad_weight),
        np.concatenate([means, broad.means]),
        np.concatenate([covariances, broad.covariances]),
    )


def broad_mixture(samples: FloatArray, n_values: int, deviation: float) -> Mixture:
    """Return one component that allows any coefficients after any history.

    Args:
        samples: (N, K).
        n_values: Coefficients per frame; the K values are whole frames.
        deviation: Of every coefficient.
    """
    n_frames = samples.shape[1] // n_values
    # Neighbouring frames stay alike, but only loosely.
    lag = np.abs(np.subtract.outer(np.arange(n_frames), np.arange(n_frames)))
    covariance = deviation**2 * np.kron(0.7**lag, np.eye(n_values))
    return Mixture(np.ones(1), samples.mean(axis=0)[None], covariance[None])


def first_shares(
    rng: np.random.Generator, samples: FloatArray, n_values: int, n_components: int
) -> FloatArray:
    """Return hard starting responsibilities (N, S + 1) by speed and by pose.

    Components must part still from moving frames, which differ little in position, so a third of
    them starts in each third of the speeds, at centres chosen far from each other.
    """
    change = samples[:, :n_values] - samples[:, -n_values:]
    speed = np.sqrt((change**2).sum(axis=1))
    third = np.searchsorted(np.quantile(speed, [1 / 3, 2 / 3]), speed)
    shares = np.zeros((samples.shape[0], n_components + 1))
    feature = np.concatenate([samples[:, :n_values], 2 * change], axis=1)
    for group in range(3):
        rows = np.flatnonzero(third == group)
        labels = range(group, n_components, 3)
        centers = feature[rows[rng.integers(rows.size)]][None]
        distance = np.full(rows.size, np.inf)
        for _ in labels:
            distance = np.minimum(distance, ((feature[rows] - centers[-1]) ** 2).sum(axis=1))
            chosen = rng.choice(rows.size, p=distance / distance.sum())
            centers = np.concatenate([centers, feature[rows[chosen]][None]])
        centers = centers[1:]
        nearest = ((feature[rows, None] - centers) ** 2).sum(axis=2).argmin(axis=1)
        shares[rows, np.array(labels)[nearest]] = 1.0
    return shares


def fit_mixture(
    rng: np.random.Generator, samples: FloatArray, n_values: int, settings: MixtureSettings
) -> tuple[Mixture, float]:
    """Return the mixture of samples (N, K) and its mean log likelihood per sample."""
    broad = broad_mixture(samples, n_values, settings.broad_deviation)
    shares = first_shares(rng, samples, n_values, settings.components)
    mixture = maximisation(samples, shares, settings, broad)
    level = -np.inf
    for _ in range(settings.rounds):
        shares, level = expectation(mixture, samples)
        mixture = maximisation(samples, shares, settings, broad)
    return mixture, level
