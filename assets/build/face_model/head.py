"""The topology of the model: which vertices and faces of the base mesh it keeps."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from assets.build.face_model.source import ObjMesh, Wheel

PART_NAMES = ("skin", "mouth", "eye_right", "eye_left", "teeth", "tongue", "lashes")
#: Groups of the base mesh after the head crop, in the order of the model's vertices.
GROUPS = (
    ("helper-r-eye", "eye_right"),
    ("helper-l-eye", "eye_left"),
    ("helper-upper-teeth", "teeth"),
    ("helper-lower-teeth", "teeth"),
    ("helper-tongue", "tongue"),
    ("helper-r-eyelashes-1", "lashes"),
    ("helper-r-eyelashes-2", "lashes"),
    ("helper-l-eyelashes-1", "lashes"),
    ("helper-l-eyelashes-2", "lashes"),
)
JOINTS = {"eye_center_right": "joint-r-eye", "eye_center_left": "joint-l-eye"}


@dataclass(frozen=True)
class Head:
    """The model's topology and what the builder needs to know of each vertex.

    Attributes:
        source: (V,) base mesh vertex; -1 for the two eye centres at the end.
        joint_cubes: (2, 8) base mesh vertices whose mean is an eye centre, right then left.
        mirror: (V,) vertex on the other side.
        quads: (F, 4) model vertices.
        corners: (F, 4) texture points of the base mesh.
        part: (F,) index into PART_NAMES.
        group: vertex indices of each group name.
        bone_weights: (V,) weight of each bone name.
        base_mm: (n, 3) base mesh.
        texture_points: (m, 2) of the base mesh, v up.
    """

    source: np.ndarray
    joint_cubes: np.ndarray
    mirror: np.ndarray
    quads: np.ndarray
    corners: np.ndarray
    part: np.ndarray
    group: dict[str, np.ndarray]
    bone_weights: dict[str, np.ndarray]
    base_mm: np.ndarray
    texture_points: np.ndarray

    @property
    def n_vertices(self) -> int:
        """Return V."""
        return len(self.source)

    def take(self, base_field: np.ndarray) -> np.ndarray:
        """Return a field on the base mesh (n, 3) at the model's vertices (V, 3)."""
        centres = base_field[self.joint_cubes].mean(axis=1)
        return np.concatenate([base_field[self.source[:-2]], centres])

    def mirrored(self, points: np.ndarray) -> np.ndarray:
        """Return positions or displacements (..., V, 3) reflected to the other side."""
        return points[..., self.mirror, :] * np.array([-1.0, 1.0, 1.0])


def head_weights(wheel: Wheel, count: int) -> dict[str, np.ndarray]:
    """Return the (n,) weights of every bone of head, jaw, face and upper neck."""
    bones = wheel.json("rigs/standard/rig.default.json")
    bones = bones.get("bones", bones)
    weights = wheel.json("rigs/standard/weights.default.json")
    weights = weights.get("weights", weights)

    def belongs(name: str) -> bool:
        while name:
            if name in ("head", "neck02", "neck03"):
                return True
            name = bones[name].get("parent") or ""
        return False

    out = {}
    for name in sorted(weights):
        if name in bones and belongs(name):
            field = np.zeros(count)
            pairs = np.array(weights[name]).reshape(-1, 2)
            field[pairs[:, 0].astype(int)] = pairs[:, 1]
            out[name] = field
    return out


def body_faces(mesh: ObjMesh, weights: dict[str, np.ndarray]) -> list[list[tuple[int, int]]]:
    """Return the faces of the head crop: every corner belongs to the head by more than half."""
    total = sum(weights.values())
    return [f for f in mesh.faces["body"] if min(total[v] for v, _ in f) > 0.5]


def inside_mouth(mesh: ObjMesh, corners: np.ndarray) -> np.ndarray:
    """Return (F,) True for the faces of the mouth cavity, an island of its own in the UVs."""
    centre = mesh.texture_points[corners].mean(axis=1)
    return (centre[:, 0] > 0.75) & (centre[:, 0] < 0.93) & (centre[:, 1] < 0.15)


def build_head(wheel: Wheel) -> Head:
    """Return the model's topology."""
    mesh = wheel.mesh()
    weights = head_weights(wheel, len(mesh.vertices_mm))
    skin = body_faces(mesh, weights)
    source = sorted({v for face in skin for v, _ in face})
    group = {"body": np.arange(len(source))}
    faces = [(face, None) for face in skin]
    for name, part in GROUPS:
        inside = sorted({v for face in mesh.faces[name] for v, _ in face} - set(source))
        group[name] = np.arange(len(source), len(source) + len(inside))
        source += inside
        faces += [(face, PART_NAMES.index(part)) for face in mesh.faces[name]]
    corners = np.array([[t for _, t in face] for face, _ in faces])
    mouth = inside_mouth(mesh, corners)
    part = np.array([int(mouth[i]) if p is None else p for i, (_, p) in enumerate(faces)])
    where = {v: i for i, v in enumerate(source)}
    cubes = [{v for f in mesh.faces[joint] for v, _ in f} for joint in JOINTS.values()]
    cubes = np.array([sorted(cube) for cube in cubes])
    source = np.array([*source, -1, -1])
    points = np.concatenate([mesh.vertices_mm[source[:-2]], mesh.vertices_mm[cubes].mean(axis=1)])
    return Head(
        source=source,
        joint_cubes=cubes,
        mirror=mirror_vertices(points),
        quads=np.array([[where[v] for v, _ in face] for face, _ in faces]),
        corners=corners,
        part=part,
        group=group,
        bone_weights={k: np.append(w[source[:-2]], [0.0, 0.0]) for k, w in weights.items()},
        base_mm=mesh.vertices_mm,
        texture_points=mesh.texture_points,
    )


def mirror_vertices(points: np.ndarray) -> np.ndarray:
    """Return (V,) the vertex at the mirrored place of each vertex of the base mesh."""
    distance, mirror = cKDTree(points).query(points * [-1, 1, 1])
    if distance.max() > 1e-6 or len(set(mirror)) != len(points):
        raise SystemExit("the base mesh is not mirror-symmetric; is it another version?")
    return mirror
