"""Software renderer for looking at the face model: shaded pictures and contact sheets."""

import moderngl
import numpy as np

VERTEX = """
#version 330
in vec3 position; in vec3 normal; in vec3 color;
uniform mat4 project; out vec3 n; out vec3 c; out vec3 p;
void main() { gl_Position = project * vec4(position, 1.0); n = normal; c = color; p = position; }
"""
FRAGMENT = """
#version 330
in vec3 n; in vec3 c; in vec3 p; out vec4 color;
void main() {
    vec3 k = normalize(n);
    vec3 view = normalize(vec3(0, 0, -700.0) - p);
    if (dot(k, view) < 0.0) k = -k;
    float key = max(dot(k, normalize(vec3(-0.5, -0.6, -0.9))), 0.0);
    float fill = max(dot(k, normalize(vec3(0.9, -0.1, -0.6))), 0.0);
    vec3 h = normalize(view + normalize(vec3(-0.5, -0.6, -0.9)));
    float shine = pow(max(dot(k, h), 0.0), 30.0) * 0.10;
    color = vec4(pow(c * (0.10 + 0.75 * key + 0.28 * fill) + shine, vec3(1.0 / 2.2)), 1.0);
}
"""


class Painter:
    """Draws a mesh with smooth normals, one colour per corner, into an RGB picture."""

    def __init__(self, size_px: tuple[int, int]) -> None:
        self._gl = moderngl.create_context(standalone=True, backend="egl")
        self._program = self._gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        self._size = size_px
        big = (size_px[0] * 2, size_px[1] * 2)
        self._frame = self._gl.framebuffer(
            [self._gl.renderbuffer(big)], self._gl.depth_renderbuffer(big)
        )

    def draw(
        self, points: np.ndarray, triangles: np.ndarray, colors: np.ndarray, view: np.ndarray
    ) -> np.ndarray:
        """Return the picture (H, W, 3) uint8 of a mesh with (T, 3, 3) corner colours."""
        normals = corner_normals(points, triangles)
        data = np.concatenate([points[triangles], normals[triangles], colors], axis=-1)
        buffer = self._gl.buffer(data.astype("f4").tobytes())
        layout = [(buffer, "3f 3f 3f", "position", "normal", "color")]
        array = self._gl.vertex_array(self._program, layout)
        self._frame.use()
        self._gl.enable(moderngl.DEPTH_TEST)
        self._frame.clear(0.82, 0.84, 0.87, 1.0)
        self._program["project"].write(view.T.astype("f4").tobytes())
        array.render()
        width, height = self._frame.size
        raw = np.frombuffer(self._frame.read(components=3), np.uint8)
        picture = raw.reshape(height, width, 3)[::-1].astype(np.uint16)
        array.release()
        buffer.release()
        small = picture.reshape(height // 2, 2, width // 2, 2, 3).sum(axis=(1, 3)) // 4
        return small.astype(np.uint8)


def corner_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return area-weighted vertex normals (V, 3)."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    normals = np.zeros_like(points, dtype=float)
    for k in range(3):
        np.add.at(normals, triangles[:, k], faces)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def look(
    center_mm: np.ndarray, width_mm: float, yaw_rad: float = 0.0, pitch_rad: float = 0.0,
    aspect: float = 1.0,
) -> np.ndarray:  # fmt: skip
    """Return the (4, 4) projection that shows a width around a point, head turned by yaw."""
    cy, sy, cp, sp = np.cos(yaw_rad), np.sin(yaw_rad), np.cos(pitch_rad), np.sin(pitch_rad)
    turn = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]])
    tilt = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    rotation = tilt @ turn
    distance, near, far = 700.0, 300.0, 1200.0
    scale = 2 * distance / width_mm
    model = np.eye(4)
    model[:3, :3] = rotation
    model[:3, 3] = -rotation @ center_mm + [0, 0, distance]
    depth = np.array([(far + near) / (far - near), -2 * far * near / (far - near)])
    project = np.array(
        [[scale, 0, 0, 0], [0, -scale * aspect, 0, 0], [0, 0, *depth], [0, 0, 1, 0]]
    )
    return project @ model
