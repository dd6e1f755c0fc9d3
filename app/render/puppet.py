"""Poses an avatar: morphs it, turns its eyes, bends its neck."""

import numpy as np

from app.render.avatar import Avatar, Part
from app.render.eyeball import eyeball, gaze_matrix
from app.render.renderer import Item, Renderer
from app.render.scene import Mesh, Uniforms
from app.render.thinning import thinned
from core.arkit import EXPRESSION_NAMES
from core.geometry import (
    matrix_from_rotation_vector,
    rotation_vector_from_matrix,
)
from core.kernels.morph import add_sparse_deltas, interleave, vertex_normals
from core.records import F32, FloatArray

_BLINK = [EXPRESSION_NAMES.index("eyeBlink" + side) for side in ("Right", "Left")]
_WIDE = [EXPRESSION_NAMES.index("eyeWide" + side) for side in ("Right", "Left")]
_JAW_OPEN, _MOUTH_CLOSE = EXPRESSION_NAMES.index("jawOpen"), EXPRESSION_NAMES.index("mouthClose")
#: Lips can close what the jaw has opened, and press a little more.
PRESSED = 0.08
#: Lid closing per rad of looking down and widening per rad of looking up.
LID_FOLLOWS_DOWN, LID_FOLLOWS_UP = 0.75, 0.5
#: Lips this far apart let all light into the mouth.
FULLY_OPEN_MM = 14.0


def lids_following(expression: FloatArray, gaze_rad: FloatArray) -> FloatArray:
    """Return the expression (46,) with lids that follow the gaze, as living ones do.

    A tracked blink already contains the follow of the real lid, so the greater of both counts,
    not their sum. Lips do not close further than the jaw has opened them.
    """
    out: FloatArray = np.clip(np.asarray(expression, float), 0, 1)
    for eye in range(2):
        pitch = float(gaze_rad[eye, 1])
        out[_BLINK[eye]] = max(out[_BLINK[eye]], min(-LID_FOLLOWS_DOWN * pitch, 0.45))
        # A closing eye does not widen.
        wide = min(LID_FOLLOWS_UP * pitch, 0.4) * (1 - out[_BLINK[eye]])
        out[_WIDE[eye]] = max(out[_WIDE[eye]], wide)
    out[_MOUTH_CLOSE] = min(out[_MOUTH_CLOSE], out[_JAW_OPEN] + PRESSED)
    return out


class Puppet:
    """An avatar on the graphics card."""

    def __init__(self, renderer: Renderer, avatar: Avatar, exact: bool = True) -> None:
        """Upload an avatar.

        Args:
            renderer: What draws it.
            avatar: Who.
            exact: Draw every triangle; otherwise a software driver draws fewer, which nobody
                sees in a picture of a usual size.
        """
        self._avatar = avatar
        parts = avatar.parts
        if renderer.software and not exact:
            parts = tuple(thinned(part, avatar.neutral_mm) for part in parts)
        self._parts = parts
        self._vertices = avatar.neutral_mm.copy()
        self._normals = np.empty_like(self._vertices)
        vertex_normals(self._vertices, avatar.triangles, self._normals)
        self._buffers = [np.empty((len(part.rows), 6), np.float32) for part in parts]
        self._drawables = [
            renderer.upload(_mesh(part, self._vertices, self._normals), part.material)
            for part in parts
        ]
        self._directions, uv, triangles = eyeball()
        extra = np.tile(np.array([0, 1, 1, 0], np.float32), (len(uv), 1))
        ball = Mesh(self._directions, self._directions, uv, extra, triangles)
        self._eyes = [renderer.upload(ball, material) for material in avatar.eyes.materials]

    def items(
        self,
        expression: FloatArray,
        gaze_rad: FloatArray,
        head_to_camera: FloatArray,
        body_to_camera: FloatArray,
    ) -> list[Item]:
        """Move the avatar and return what to draw.

        Args:
            expression: (46,) coefficients.
            gaze_rad: (2, 2) yaw and pitch of the right, then the left eye.
            head_to_camera: (4, 4).
            body_to_camera: (4, 4); `body_below` gives one.
        """
        weights = lids_following(expression, gaze_rad).astype(np.float32)
        self._morph(weights)
        mouth: Uniforms = {"lit": self._light_in_mouth()}
        items = [
            Item(
                drawable,
                head_to_camera,
                body_to_camera,
                mouth if drawable.material.in_mouth else {},
            )
            for drawable in self._drawables
        ]
        return items + [
            self._eye_item(eye, gaze_rad[eye], head_to_camera, body_to_camera) for eye in range(2)
        ]

    def release(self) -> None:
        """Free what is on the graphics card."""
        for drawable in (*self._drawables, *self._eyes):
            drawable.release()

    def _morph(self, weights: F32) -> None:
        avatar = self._avatar
        self._vertices[:] = avatar.neutral_mm
        add_sparse_deltas(
            weights, avatar.delta_starts, avatar.delta_rows, avatar.deltas_mm, self._vertices
        )
        if avatar.seal is not None:
            avatar.seal.close(self._vertices)
        vertex_normals(self._vertices, avatar.triangles, self._normals)
        for part, drawable, buffer in zip(self._parts, self._drawables, self._buffers, strict=True):
            interleave(self._vertices, self._normals, part.rows, buffer)
            drawable.move(buffer)

    def _light_in_mouth(self) -> float:
        upper, lower = self._vertices[self._avatar.lip_rows]
        share = float(np.clip((lower[1] - upper[1]) / FULLY_OPEN_MM, 0, 1))
        return 0.5 + 0.5 * share

    def _eye_item(
        self, eye: int, gaze_rad: FloatArray, head_to_camera: FloatArray, body: FloatArray
    ) -> Item:
        eyes = self._avatar.eyes
        center = eyes.centers_mm[eye]
        turn = gaze_matrix(float(gaze_rad[0]), float(gaze_rad[1]))
        looking = (self._directions @ turn.T).astype(np.float32)
        buffer = np.empty((len(looking), 6), np.float32)
        buffer[:, :3], buffer[:, 3:] = eyes.radii_mm[eye] * looking + center, looking
        self._eyes[eye].move(buffer)
        inner, outer, upper, lower = self._vertices[eyes.lid_rows[eye]] - center
        # Columns x, y and outward axis; OpenGL reads a matrix column by column.
        axes = head_to_camera[:3, :3] @ turn @ np.diag([1, 1, -1])
        values: Uniforms = {
            "axes": axes.T,
            "center": center,
            "lids": np.array([inner[0], outer[0], upper[1], lower[1]]),
            "corners": np.array([inner[1], outer[1]]),
        }
        return Item(self._eyes[eye], head_to_camera, body, values)


def body_below(
    avatar: Avatar, head_to_camera: FloatArray, upright: FloatArray, follow: float = 0.2
) -> FloatArray:
    """Return where the body is, (4, 4), for a pose of the head.

    The neck's top stays in place under the skull; the body turns a little with the head.

    Args:
        avatar: Its pivot joins head and body.
        head_to_camera: (4, 4).
        upright: (3, 3) rotation of a body at rest, the identity facing the camera.
        follow: Share of the head's turn that the body makes.
    """
    rotation = upright @ _part_of_turn(upright.T @ head_to_camera[:3, :3], follow)
    out = np.eye(4)
    out[:3, :3] = rotation
    joint = head_to_camera[:3, :3] @ avatar.pivot_mm + head_to_camera[:3, 3]
    out[:3, 3] = joint - rotation @ avatar.pivot_mm
    return out


def _part_of_turn(rotation: FloatArray, share: float) -> FloatArray:
    """Return a share of a rotation about its own axis."""
    return matrix_from_rotation_vector(share * rotation_vector_from_matrix(rotation))


def _mesh(part: Part, vertices: F32, normals: F32) -> Mesh:
    return Mesh(vertices[part.rows], normals[part.rows], part.uv, part.extra, part.triangles)
