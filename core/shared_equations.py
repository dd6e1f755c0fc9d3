"""The normal equations of what all pictures share: identity weights and landmark offsets.

An offset moves one landmark only, so its columns of the Jacobian are zero but for two rows a
picture. Multiplying them out as such would cost fifteen times as much.
"""

from dataclasses import dataclass

import numpy as np

from core.landmarks import N_INTERNAL
from core.records import FloatArray

N_OFFSETS = 3 * N_INTERNAL


@dataclass(frozen=True, slots=True, eq=False)
class SharedJacobian:
    """d(projection)/d(identity, offsets) of all pictures, times the root of the weights.

    Attributes:
        identity: (N, L, 2, I).
        offsets: (N, 60, 2, 3) of each landmark by its own offset.
    """

    identity: FloatArray
    offsets: FloatArray

    def gradient(self, residuals: FloatArray) -> FloatArray:
        """Return J'r (I + 180,) of weighted residuals (N, L, 2)."""
        flat = self.identity.reshape(-1, self.identity.shape[-1])
        by_offset = np.einsum("nlcd,nlc->ld", self.offsets, residuals[:, :N_INTERNAL])
        return np.concatenate([residuals.ravel() @ flat, by_offset.ravel()])

    def hessian(self) -> FloatArray:
        """Return J'J (I + 180, I + 180)."""
        n_identity = self.identity.shape[-1]
        flat = self.identity.reshape(-1, n_identity)
        out = np.zeros((n_identity + N_OFFSETS, n_identity + N_OFFSETS))
        out[:n_identity, :n_identity] = flat.T @ flat
        # (60, 3, 2 N) times (60, 2 N, I).
        offsets = self.offsets.transpose(1, 3, 0, 2).reshape(N_INTERNAL, 3, -1)
        identity = self.identity[:, :N_INTERNAL].transpose(1, 0, 2, 3)
        mixed = (offsets @ identity.reshape(N_INTERNAL, -1, n_identity)).reshape(N_OFFSETS, -1)
        out[n_identity:, :n_identity], out[:n_identity, n_identity:] = mixed, mixed.T
        own = offsets @ np.swapaxes(offsets, 1, 2)
        for landmark in range(N_INTERNAL):
            place = slice(n_identity + 3 * landmark, n_identity + 3 * landmark + 3)
            out[place, place] = own[landmark]
        return out

    def cross(self, local: FloatArray) -> FloatArray:
        """Return K'J (N, P, I + 180) with the weighted local Jacobians (N, L, 2, P) as K."""
        n_pictures, _, _, n_local = local.shape
        n_identity = self.identity.shape[-1]
        out = np.empty((n_pictures, n_local, n_identity + N_OFFSETS))
        transposed = np.swapaxes(local.reshape(n_pictures, -1, n_local), 1, 2)
        np.matmul(
            transposed,
            self.identity.reshape(n_pictures, -1, n_identity),
            out=out[..., :n_identity],
        )
        # Two terms written out: a batched product of such small matrices is slow.
        inner = local[:, :N_INTERNAL]
        by_offset = inner[:, :, 0, :, None] * self.offsets[:, :, 0, None, :]
        by_offset += inner[:, :, 1, :, None] * self.offsets[:, :, 1, None, :]
        out[..., n_identity:] = by_offset.transpose(0, 2, 1, 3).reshape(n_pictures, n_local, -1)
        return out
