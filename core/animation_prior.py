"""The animation prior: a Gaussian mixture over a frame's and the previous frames' coefficients.

[Cao13, face tracking, eq. 12] has one mixture over all coefficients. We have one for each small
group of coefficients that explain the same points, and multiply them. Faces move a few muscles at
a time: in one joint mixture a component that lets one coefficient move lets all of them loose
(a blink would make the mouth tremble), and a movement that no component foresaw is held back by
the sum of what all the resting coefficients pay. In a small group both are small.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.errors import CoreError
from core.kernels.tracking import PriorTables
from core.records import F32, I32, FloatArray, freeze

if TYPE_CHECKING:
    from pathlib import Path

#: Previous frames in the mixture, n of [Cao13, eq. 12].
N_LAGS = 3
#: The groups; a name without its side stands for both sides.
REGIONS: dict[str, tuple[str, ...]] = {
    "lids": ("eyeBlink", "eyeWide", "eyeSquint"),
    "brows": ("browDown", "browInnerUp", "browOuterUp"),
    "cheeks": ("cheekPuff", "cheekSuck"),
    "sideways": ("jawForward", "jawLeft", "jawRight", "mouthLeft", "mouthRight"),
    "opening": ("jawOpen", "mouthClose", "mouthFunnel", "mouthPucker"),
    "corners": ("mouthSmile", "mouthFrown", "mouthDimple", "mouthStretch", "cheekSquint"),
    "upper lip": ("mouthUpperUp", "mouthRollUpper", "mouthShrugUpper", "noseSneer"),
    "lower lip": ("mouthLowerDown", "mouthRollLower", "mouthShrugLower", "mouthPress"),
}  # fmt: skip


class PriorFileError(CoreError):
    """The animation prior's file lacks what it must hold."""

    def __init__(self, path: "Path", missing: str) -> None:
        self.path, self.missing = path, missing
        super().__init__(
            f"animation prior {path}: found no array {missing!r}; the file is damaged or older "
            "than the program, make it again with assets/build/animation_prior.py"
        )


@dataclass(frozen=True, slots=True, eq=False)
class RegionMixture:
    """The mixture of one region; K = (1 + N_LAGS) * N values: this frame, then earlier ones.

    Attributes:
        members: (N,) indices of the region's coefficients.
        weights: (S,) sum 1.
        means: (S, K).
        covariances: (S, K, K).
    """

    members: I32
    weights: FloatArray
    means: FloatArray
    covariances: F32

    def __post_init__(self) -> None:
        freeze(
            self,
            members=(np.int32, ("N",)),
            weights=(np.float64, ("S",)),
            means=(np.float64, ("S", "K")),
            covariances=(np.float32, ("S", "K", "K")),
        )


@dataclass(frozen=True, slots=True, eq=False)
class AnimationPrior:
    """The prior of all coefficients: the product of its regions' mixtures.

    Attributes:
        frame_s: Time between the frames that it was trained on.
        regions: One mixture per region; together they hold every coefficient once.
    """

    frame_s: float
    regions: tuple[RegionMixture, ...]


def members(region: str) -> I32:
    """Return the indices (N,) of a region's coefficients."""
    names = []
    for name in REGIONS[region]:
        names += [name] if name in EXPRESSION_NAMES else [name + "Left", name + "Right"]
    return np.array([EXPRESSION_NAMES.index(name) for name in names], np.int32)


def pack_symmetric(matrices: FloatArray) -> F32:
    """Return the lower triangles (S, K (K + 1) / 2) of symmetric matrices (S, K, K)."""
    rows, columns = np.tril_indices(matrices.shape[-1])
    return np.asarray(matrices[:, rows, columns], np.float32)


def unpack_symmetric(packed: F32) -> F32:
    """Return the symmetric matrices (S, K, K) of their lower triangles."""
    size = int(np.sqrt(2 * packed.shape[1]))
    rows, columns = np.tril_indices(size)
    out = np.empty((packed.shape[0], size, size), np.float32)
    out[:, rows, columns] = packed
    out[:, columns, rows] = packed
    return out


def save_animation_prior(path: "Path", prior: AnimationPrior) -> None:
    """Write a prior to an .npz file."""
    arrays: dict[str, FloatArray | F32 | I32] = {"frame_s": np.array(prior.frame_s)}
    for name, region in zip(REGIONS, prior.regions, strict=True):
        arrays[f"{name}_weights"] = region.weights
        arrays[f"{name}_means"] = region.means.astype(np.float32)
        arrays[f"{name}_covariances"] = pack_symmetric(np.asarray(region.covariances, float))
    np.savez_compressed(path, allow_pickle=False, **arrays)


def load_animation_prior(path: "Path") -> AnimationPrior:
    """Read the prior that `save_animation_prior` wrote.

    Raises:
        PriorFileError: An array is missing.
    """
    with np.load(path) as stored:
        try:
            regions = tuple(
                RegionMixture(
                    members(name),
                    stored[f"{name}_weights"],
                    stored[f"{name}_means"],
                    unpack_symmetric(stored[f"{name}_covariances"]),
                )
                for name in REGIONS
            )
            return AnimationPrior(float(stored["frame_s"]), regions)
        except KeyError as error:
            raise PriorFileError(path, str(error.args[0]).split()[0].strip("'\"")) from error


def conditional_tables(prior: AnimationPrior, first_lag: int) -> PriorTables:
    """Return what the tracker needs of the mixture when the history starts at `first_lag`.

    A dropped frame is a lag of which nothing is known, so it is integrated out: with one frame
    dropped the history is lags 2..3. Past the last lag only the marginal of the frame itself is
    left.

    Args:
        prior: The mixtures.
        first_lag: 1 = the previous frame is known; N_LAGS + 1 = no history.
    """
    n_lags = N_LAGS + 1 - first_lag
    n = max(region.members.size for region in prior.regions)
    s = max(region.weights.size for region in prior.regions)
    z, h = len(prior.regions), n * n_lags
    tables = PriorTables(
        members=np.zeros((z, n), np.int32),
        counts=np.zeros((z, 3), np.int32),
        log_weights=np.zeros((z, s)),
        means=np.zeros((z, s, n), np.float32),
        history_means=np.zeros((z, s, h), np.float32),
        maps=np.zeros((z, s, n, h), np.float32),
        precisions=np.zeros((z, s, n, n), np.float32),
        whiteners=np.zeros((z, s, h, h), np.float32),
    )
    for index, region in enumerate(prior.regions):
        size = region.members.size
        tables.members[index, :size] = region.members
        tables.counts[index] = size, size * n_lags, region.weights.size
        for component in range(region.weights.size):
            _condition_component(tables, index, component, region, first_lag)
    return tables


def _condition_component(
    tables: PriorTables, z: int, s: int, region: RegionMixture, first_lag: int
) -> None:
    """Fill the tables of one component from the blocks of its covariance."""
    n = region.members.size
    h = n * (N_LAGS + 1 - first_lag)
    mean = region.means[s]
    covariance = np.asarray(region.covariances[s], float)
    past = slice(first_lag * n, mean.size)
    past_precision = np.linalg.inv(covariance[past, past])
    gain = covariance[:n, past] @ past_precision
    precision = np.linalg.inv(covariance[:n, :n] - gain @ covariance[past, :n])
    tables.means[z, s, :n] = mean[:n]
    tables.history_means[z, s, :h] = mean[past]
    tables.maps[z, s, :n, :h] = gain
    tables.precisions[z, s, :n, :n] = 0.5 * (precision + precision.T)
    whitener = np.linalg.inv(np.linalg.cholesky(covariance[past, past]))
    tables.whiteners[z, s, :h, :h] = whitener
    half_log_determinants = np.log(np.diag(whitener)).sum() + 0.5 * np.linalg.slogdet(precision)[1]
    tables.log_weights[z, s] = np.log(region.weights[s]) + half_log_determinants
