"""The sculpted expressions on any head.

A displacement is turned and stretched as the head around it is: multiplied by the smoothed
3 x 3 deformation from the reference head. That is linear in the head's vertices, so the
bilinear model can hold it exactly. Lids, lower teeth, tongue and lip contact are then made anew
for the head.
"""

import numpy as np
from scipy.sparse import csr_matrix, diags
from scipy.spatial import cKDTree

from assets.build.face_model.lids import LidMove
from assets.build.face_model.sculpt import CLOSED_MOUTH, Sculpture
from assets.build.face_model.sculpt_open import FORWARD, LEFT, OPEN
from assets.build.face_model.sculptor import Sculptor
from assets.build.face_model.settle import Settler
from assets.build.face_model.surface import smooth_step

#: Width of the neighbourhood whose deformation a displacement follows, and its cut-off.
SIGMA_MM, CUT_MM = 10.0, 22.0
#: Strength of the pull towards no deformation across the skin, where little is known.
RIDGE_MM2 = 12.0
#: Distance from the lids' rims within which other shapes fade out.
QUIET_MM = 9.0
BLINK = LidMove(upper=0.90, lower=0.10, settle=0.7, lift_mm=0.3, overlap_mm=0.45)
LID_MOVES = {
    "eyeBlinkLeft": BLINK,
    "eyeWideLeft": LidMove(upper=-0.30, lower=-0.06),
    "eyeSquintLeft": LidMove(upper=0.14, lower=0.32),
    "cheekSquintLeft": LidMove(upper=0.0, lower=0.14),
    "mouthSmileLeft": LidMove(upper=0.0, lower=0.06),
    "browDownLeft": LidMove(upper=0.06, lower=0.0),
    "noseSneerLeft": LidMove(upper=0.0, lower=0.06),
}
JAW_MOVES = {"jawOpen": OPEN, "jawForward": FORWARD, "jawLeft": LEFT}
#: The tongue sinks to the floor of an open mouth.
TONGUE_REST_MM = {"jawOpen": np.array([0.0, 3.5, 5.0])}
#: Closed shapes and the share of the upper lip in the common movement of the lips.
SEALED = dict.fromkeys(CLOSED_MOUTH, 0.5) | {
    "mouthRollLower": 0.75, "mouthRollUpper": 0.25, "mouthShrugUpper": 0.7,
    "cheekPuffLeft": 0.5, "cheekSuck": 0.5, "noseSneerLeft": 0.35,
}  # fmt: skip


class Transfer:
    """Carries the sculpture of the reference head over to other heads."""

    def __init__(self, sculptor: Sculptor, sculpture: Sculpture, settler: Settler) -> None:
        self.names = tuple(sorted({*sculpture.fields, *LID_MOVES}))
        self._sculptor, self._jaw, self._settler = sculptor, sculpture.jaw, settler
        quiet = quiet_lids(sculptor, settler)
        empty = np.zeros_like(sculptor.reference)
        fields = [sculpture.fields.get(name, empty) for name in self.names]
        self._fields = np.stack(fields)[:, : sculptor.surface.n] * quiet[:, None]
        self._reference = sculptor.surface.points
        self._near = neighbourhoods(self._reference)
        self._inverse = np.linalg.inv(self._moments(self._reference))

    def _moments(self, points: np.ndarray) -> np.ndarray:
        """Return the mean of e' e^T over the edges around each vertex, (n, 3, 3) mm^2."""
        products = points[:, :, None] * self._reference[:, None, :]
        mean = (self._near @ products.reshape(-1, 9)).reshape(-1, 3, 3)
        center, reference = self._near @ points, self._near @ self._reference
        return mean - center[:, :, None] * reference[:, None, :] + RIDGE_MM2 * np.eye(3)

    def deltas(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Return the left and central expressions (V, 3) mm of a settled head (V, 3)."""
        n = len(self._reference)
        deformation = self._moments(points[:n]) @ self._inverse
        moved = np.einsum("vij,bvj->bvi", deformation, self._fields)
        return {name: self._finished(name, points, moved[b]) for b, name in enumerate(self.names)}

    def _finished(self, name: str, points: np.ndarray, skin: np.ndarray) -> np.ndarray:
        """Return one expression (V, 3) with the parts that are made anew for the head."""
        out = np.zeros_like(points)
        out[: len(skin)] = skin
        if name in SEALED:
            out = self._sculptor.seal(out, SEALED[name])
        if name in LID_MOVES:
            out += self._settler.lid_move(points, LID_MOVES[name], left=True)
        if name in JAW_MOVES:
            bone = self._jaw.bone
            out[bone] = self._jaw.rigid(points, JAW_MOVES[name])[bone]
            out[self._settler.head.group["helper-tongue"]] += TONGUE_REST_MM.get(name, 0.0)
        return out


def neighbourhoods(points: np.ndarray) -> csr_matrix:
    """Return the matrix (n, n) of Gaussian weights of near vertices, rows sum to 1."""
    tree = cKDTree(points)
    near = tree.sparse_distance_matrix(tree, CUT_MM, output_type="coo_matrix").tocsr()
    near.data = np.exp(-0.5 * (near.data / SIGMA_MM) ** 2)
    near.setdiag(1.0)
    total = np.asarray(near.sum(axis=1)).ravel()
    return csr_matrix(diags(1 / total) @ near)


def quiet_lids(sculptor: Sculptor, settler: Settler) -> np.ndarray:
    """Return (n,) 0 at the rims of the lids, 1 a few mm away: only lid moves move them."""
    rim = [*settler.lids.upper_rim, *settler.lids.lower_rim]
    both = [*rim, *settler.head.mirror[rim]]
    return np.asarray(smooth_step(sculptor.surface.distance(both) / QUIET_MM))
