"""How much of the sky each vertex of the mean head sees: the soft shadow in folds.

Writes assets/avatars/openness.npz: `python -m assets.build.textures_openness`. The head is drawn
from many directions; a vertex is open to a direction if nothing is drawn before it.
"""

from pathlib import Path

import moderngl
import numpy as np

from core.face_model import PART_NAMES, FaceModel, load_face_model
from core.kernels.morph import vertex_normals

ASSETS = Path(__file__).resolve().parents[1]
OUT = ASSETS / "avatars" / "openness.npz"
DIRECTIONS, SIZE, REACH_MM = 220, 640, 190.0
#: A vertex is looked at from this far in front of its own surface.
LIFT_MM = 1.2

VERTEX = """
#version 330
in vec3 place; uniform mat3 turn; uniform float reach;
void main() { gl_Position = vec4((turn * place) / reach, 1.0); }
"""
FRAGMENT = "#version 330\nvoid main() {}"


def main() -> None:
    """Measure and write."""
    model = load_face_model(ASSETS / "face_model.npz")
    open_share = openness(model)
    OUT.parent.mkdir(exist_ok=True)
    value = np.round(255 * open_share).astype(np.uint8)
    np.savez_compressed(OUT, openness=value)
    print(f"{OUT}: {OUT.stat().st_size} bytes, median {np.median(open_share):.2f}")


def openness(model: FaceModel) -> np.ndarray:
    """Return the share (V,) of the sky that is free above each vertex, 1 on a convex surface."""
    points = model.mean_mm.astype(float) - model.mean_mm.mean(axis=0)
    solid = model.part != PART_NAMES.index("lashes")
    triangles = model.triangles[solid]
    normals = np.empty((len(points), 3), np.float32)
    vertex_normals(points.astype(np.float32), model.triangles, normals)
    gl = moderngl.create_context(standalone=True, backend="egl")
    program = gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
    buffer = gl.buffer(points.astype("f4").tobytes())
    index = gl.buffer(triangles.astype("i4").tobytes())
    array = gl.vertex_array(program, [(buffer, "3f", "place")], index)
    frame = gl.framebuffer([], gl.depth_renderbuffer((SIZE, SIZE)))
    frame.use()
    gl.enable(moderngl.DEPTH_TEST)
    program["reach"] = REACH_MM
    free, total = np.zeros(len(points)), np.zeros(len(points))
    for direction in sphere(DIRECTIONS):
        turn = towards(direction)
        frame.clear(depth=1.0)
        program["turn"].write(turn.T.astype("f4").tobytes())
        array.render()
        depth = np.frombuffer(frame.read(components=1, attachment=-1, dtype="f4"), "f4").reshape(
            SIZE, SIZE
        )
        seen = (points + LIFT_MM * normals) @ turn.T / REACH_MM
        pixel = np.clip(((seen[:, :2] * 0.5 + 0.5) * SIZE).astype(int), 0, SIZE - 1)
        front = depth[pixel[:, 1], pixel[:, 0]] * 2 - 1
        cosine = np.maximum(normals @ -direction, 0)
        free += cosine * (seen[:, 2] < front + 1.0 / REACH_MM)
        total += cosine
    return np.clip(free / np.maximum(total, 1e-9), 0, 1)


def sphere(count: int) -> np.ndarray:
    """Return directions (n, 3) evenly spread, by the golden angle."""
    k = np.arange(count) + 0.5
    height = 1 - 2 * k / count
    turn = np.pi * (1 + 5**0.5) * k
    side = np.sqrt(1 - height**2)
    return np.column_stack([side * np.cos(turn), side * np.sin(turn), height])


def towards(direction: np.ndarray) -> np.ndarray:
    """Return the rotation (3, 3) that brings a direction to +z."""
    other = np.array([0.0, 1.0, 0.0]) if abs(direction[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    x = np.cross(other, direction)
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(direction, x), direction])


if __name__ == "__main__":
    main()
