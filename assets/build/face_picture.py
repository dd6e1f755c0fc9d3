"""Software renderer for looking at the face model: shaded, coloured pictures of a head."""

from itertools import pairwise

import moderngl
import numpy as np

from assets.build.face_subdivision import refine
from core.face_model import PART_NAMES, FaceModel

VERTEX = """
#version 330
in vec3 position; in vec3 normal; in vec3 color;
uniform mat4 project; out vec3 n; out vec3 c; out vec3 p;
void main() { gl_Position = project * vec4(position, 1.0); n = normal; c = color; p = position; }
"""
FRAGMENT = """
#version 330
in vec3 n; in vec3 c; in vec3 p; out vec4 color;
uniform vec3 eyes[2]; uniform vec3 viewer;
vec3 iris(vec3 base) {
    vec3 eye = p.x < 0.0 ? eyes[0] : eyes[1];
    float angle = degrees(acos(clamp(-normalize(p - eye).z, -1.0, 1.0)));
    vec3 out_color = mix(vec3(0.16, 0.09, 0.05), base, smoothstep(21.5, 23.0, angle));
    return out_color * smoothstep(7.5, 9.0, angle);
}
void main() {
    bool eye = c.r > 0.9;
    vec3 base = eye ? iris(vec3(0.75)) : c;
    vec3 k = normalize(n);
    vec3 view = normalize(viewer - p);
    if (dot(k, view) < 0.0) k = -k;
    vec3 lamp = normalize(vec3(-0.45, -0.75, -0.9));
    float key = max(dot(k, lamp), 0.0);
    float fill = max(dot(k, normalize(vec3(0.9, -0.1, -0.6))), 0.0);
    float shine = pow(max(dot(k, normalize(view + lamp)), 0.0), eye ? 200.0 : 30.0);
    vec3 lit = base * (0.10 + 0.75 * key + 0.28 * fill) + shine * (eye ? 0.8 : 0.06);
    color = vec4(pow(lit, vec3(1.0 / 2.2)), 1.0);
}
"""
#: Linear colours of the parts; more than 0.9 of red means "draw an iris here".
COLORS = {
    "skin": (0.60, 0.38, 0.29), "mouth": (0.16, 0.04, 0.04), "eye_right": (1, 1, 1),
    "eye_left": (1, 1, 1), "teeth": (0.72, 0.68, 0.58), "tongue": (0.45, 0.15, 0.14),
    "lashes": (0.03, 0.025, 0.02),
}  # fmt: skip
LIP_COLOR = np.array([0.50, 0.20, 0.18])
BROW_COLOR = np.array([0.08, 0.05, 0.035])
BROW = (8, 6, 4, 2, 0)
LIPS = (44, 46, 48, 40, 49, 47, 45, 51, 41, 50)


class Painter:
    """Draws faces of one model, subdivided, into RGB pictures."""

    def __init__(self, model: FaceModel, size_px: tuple[int, int], levels: int = 2) -> None:
        shown = shown_quads(model)
        self._fine = refine(model.quads[shown], len(model.mean_mm), levels)
        quads = self._fine.quads
        self._triangles = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
        part = np.tile(model.part[::2][shown][self._fine.parent], 2)
        self._colors = corner_colors(
            model, self._fine.matrix @ model.mean_mm, self._triangles, part
        )
        self._eyes = model.eye_center_vertices
        self._gl = moderngl.create_context(standalone=True, backend="egl")
        self._program = self._gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        self._aspect = size_px[0] / size_px[1]
        self._frame = self._gl.framebuffer(
            [self._gl.renderbuffer((size_px[0] * 2, size_px[1] * 2))],
            self._gl.depth_renderbuffer((size_px[0] * 2, size_px[1] * 2)),
        )

    def draw(self, points: np.ndarray, view: "View") -> np.ndarray:
        """Return the picture (H, W, 3) uint8 of a face (V, 3)."""
        fine = self._fine.matrix @ points
        normals = vertex_normals(fine, self._triangles)
        corners = self._triangles
        data = np.concatenate([fine[corners], normals[corners], self._colors], axis=-1)
        buffer = self._gl.buffer(data.astype("f4").tobytes())
        layout = [(buffer, "3f 3f 3f", "position", "normal", "color")]
        array = self._gl.vertex_array(self._program, layout)
        self._frame.use()
        self._gl.enable(moderngl.DEPTH_TEST)
        self._frame.clear(0.82, 0.84, 0.87, 1.0)
        matrix, viewer = view.matrix(self._aspect)
        self._program["project"].write(matrix.T.astype("f4").tobytes())
        self._program["viewer"].write(viewer.astype("f4").tobytes())
        self._program["eyes"].write(points[self._eyes].astype("f4").tobytes())
        array.render()
        picture = np.frombuffer(self._frame.read(components=3), np.uint8)
        array.release()
        buffer.release()
        return halved(picture.reshape(*self._frame.size[::-1], 3)[::-1])


def shown_quads(model: FaceModel) -> np.ndarray:
    """Return (F,) False for the lower lashes: without their texture they look like paint."""
    lash = model.part[::2] == PART_NAMES.index("lashes")
    low = (
        model.mean_mm[model.quads, 1].mean(axis=1) > model.mean_mm[model.eye_center_vertices[0], 1]
    )
    return ~(lash & low)


def halved(picture: np.ndarray) -> np.ndarray:
    """Return a picture at half its size, four pixels averaged."""
    height, width = picture.shape[0] // 2, picture.shape[1] // 2
    blocks = picture.astype(np.uint16).reshape(height, 2, width, 2, 3)
    return np.ascontiguousarray((blocks.sum(axis=(1, 3)) // 4).astype(np.uint8))


class View:
    """A camera that shows a width around a point, with the head turned."""

    def __init__(
        self, center_mm: tuple[float, float, float], width_mm: float,
        yaw_rad: float = 0.0, pitch_rad: float = 0.0,
    ) -> None:  # fmt: skip
        self.center_mm, self.width_mm = np.array(center_mm), width_mm
        self.yaw_rad, self.pitch_rad = yaw_rad, pitch_rad

    def matrix(self, aspect: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the (4, 4) projection and the viewer's place in the model frame."""
        cy, sy = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        cp, sp = np.cos(self.pitch_rad), np.sin(self.pitch_rad)
        turn = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]])
        rotation = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]]) @ turn
        distance, near, far = 700.0, 300.0, 1200.0
        scale = 2 * distance / self.width_mm
        model = np.eye(4)
        model[:3, :3] = rotation
        model[:3, 3] = -rotation @ self.center_mm + [0, 0, distance]
        depth = ((far + near) / (far - near), -2 * far * near / (far - near))
        project = np.array(
            [[scale, 0, 0, 0], [0, -scale * aspect, 0, 0], [0, 0, *depth], [0, 0, 1, 0]]
        )
        return project @ model, self.center_mm - rotation.T @ [0, 0, distance]


def vertex_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return area-weighted vertex normals (V, 3) that point out of the head."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    count = len(points)
    sums = [np.bincount(triangles.ravel(), np.repeat(faces[:, k], 3), count) for k in range(3)]
    normals = np.stack(sums, axis=1)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def corner_colors(
    model: FaceModel, mean: np.ndarray, triangles: np.ndarray, part: np.ndarray
) -> np.ndarray:
    """Return the colour of every triangle corner (T, 3, 3): parts, lips and brows."""
    palette = np.array([COLORS[name] for name in PART_NAMES], float)
    colors = np.repeat(palette[part][:, None], 3, axis=1)
    landmarks = model.mean_mm[model.landmark_vertices]
    lips = inside_polygon(mean, landmarks[list(LIPS)], 1.0) * (mean[:, 2] < -8)
    brows = np.zeros(len(mean))
    for line in (landmarks[list(BROW)], landmarks[[i + 1 for i in BROW]]):
        brows = np.maximum(brows, 1 - np.clip((distance_to_line(mean, line) - 2.0) / 1.6, 0, 1))
    skin = (part == 0)[:, None, None]
    for amount, color in ((lips, LIP_COLOR), (brows * 0.75, BROW_COLOR)):
        share = amount[triangles][..., None] * skin
        colors = colors * (1 - share) + color * share
    return colors


def inside_polygon(points: np.ndarray, polygon: np.ndarray, blur_mm: float) -> np.ndarray:
    """Return how far points (n, 3) are inside a closed outline seen from the front, 0 to 1."""
    ends = np.roll(polygon, -1, axis=0)
    inside = np.zeros(len(points), bool)
    for (x0, y0, _), (x1, y1, _) in zip(polygon, ends, strict=True):
        crosses = (y0 > points[:, 1]) != (y1 > points[:, 1])
        if abs(y1 - y0) > 1e-9:
            inside ^= crosses & (points[:, 0] < x0 + (points[:, 1] - y0) * (x1 - x0) / (y1 - y0))
    closed = np.vstack([polygon, polygon[:1]])
    distance = distance_to_line(points * [1, 1, 0], closed * [1, 1, 0])
    return np.clip(np.where(inside, 0.5, 0.5) + np.where(inside, 1, -1) * distance / blur_mm, 0, 1)


def distance_to_line(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Return the distance (n,) of points (n, 3) from a polyline (m, 3)."""
    best = np.full(len(points), np.inf)
    for a, b in pairwise(line):
        along = np.clip((points - a) @ (b - a) / max((b - a) @ (b - a), 1e-9), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - along[:, None] * (b - a), axis=1))
    return best
