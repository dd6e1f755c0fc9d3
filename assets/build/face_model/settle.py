"""Makes every generated neutral face wearable: lips touch, eyes open as in a photograph."""

from dataclasses import dataclass

import numpy as np

from assets.build.face_model.head import Head
from assets.build.face_model.lids import EYEBALL_SCALE, LidMove, Lids, move_lids, right_lids
from assets.build.face_model.mouth import Seal
from assets.build.face_model.sculptor import Sculptor

#: The source's eyes rest a little closed and look up; ours look straight ahead.
REST = LidMove(upper=-0.12, lower=0.05)
OVERLAP_MM = 0.5


@dataclass(frozen=True)
class Settler:
    """Finishes neutral faces (V, 3) of any identity."""

    head: Head
    seal: Seal
    lids: Lids

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Return the face with closed lips, open eyes and slightly smaller eyeballs."""
        out = self.seal.close(points, OVERLAP_MM)
        for group, center in (("helper-r-eye", -2), ("helper-l-eye", -1)):
            ball = self.head.group[group]
            out[ball] = out[center] + EYEBALL_SCALE * (out[ball] - out[center])
        return out + self.both_lids(out, REST)

    def lid_move(self, points: np.ndarray, move: LidMove, left: bool) -> np.ndarray:
        """Return the displacement of moving one eye's lids."""
        if not left:
            return move_lids(self.lids, points, points[-2], move)
        mirrored = self.head.mirrored(points)
        field = move_lids(self.lids, mirrored, mirrored[-2], move)
        return np.asarray(self.head.mirrored(field))

    def both_lids(self, points: np.ndarray, move: LidMove) -> np.ndarray:
        """Return the displacement of moving the lids of both eyes."""
        return self.lid_move(points, move, True) + self.lid_move(points, move, False)


def make_settler(sculptor: Sculptor) -> Settler:
    """Return the settler whose charts are drawn on the sculptor's head."""
    head = sculptor.head
    return Settler(
        head, sculptor.seal, right_lids(head, sculptor.surface, sculptor.reference[-2])
    )
