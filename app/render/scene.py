"""What can be drawn: meshes, materials, lights, a view. Plain records, no OpenGL."""

from dataclasses import dataclass, field

import numpy as np

from core.records import F32, I32, U8, Camera, FloatArray, freeze

#: Values of a shader's uniforms by name: a number or a small array.
Uniforms = dict[str, float | FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh in the model frame; texture seams repeat vertices.

    Attributes:
        vertices_mm: (V, 3).
        normals: (V, 3) unit, outwards.
        uv: (V, 2) in the texture, v = 0 at its first row.
        extra: (V, 4) hold of the body (0 moves with the head, 1 with the body), openness to the
            light in [0, 1], and two values that only some materials read (hair: coverage).
        triangles: (T, 3) counter-clockwise seen from outside.
    """

    vertices_mm: F32
    normals: F32
    uv: F32
    extra: F32
    triangles: I32

    def __post_init__(self) -> None:
        freeze(
            self,
            vertices_mm=(np.float32, ("V", 3)),
            normals=(np.float32, ("V", 3)),
            uv=(np.float32, ("V", 2)),
            extra=(np.float32, ("V", 4)),
            triangles=(np.int32, ("T", 3)),
        )


#: What each shader's surfaces have unless their material says otherwise: how far light wraps
#: round the edge of the shadow by colour, the roughness to the fourth, the colour of folds, the
#: direction that strands of hair run away from (zero: no strands).
DEFAULTS: dict[str, Uniforms] = {
    "skin": {
        "wrap": np.array([0.42, 0.20, 0.14]),
        "roughness2": 0.11,
        "bounce": np.array([0.45, 0.22, 0.15]),
        "whorl": np.zeros(3),
    },
    "eye": {},
    "hair": {
        "wrap": np.array([0.5, 0.5, 0.5]),
        "roughness2": 0.11,
        "bounce": np.zeros(3),
        "whorl": np.array([0.0, -0.8, 0.6]),
        "cutoff": 0.42,
        "shine": 0.55,
    },
    "plain": {
        "wrap": np.array([0.2, 0.2, 0.2]),
        "roughness2": 0.11,
        "bounce": np.zeros(3),
        "whorl": np.zeros(3),
    },
    "wet": {
        "wrap": np.array([0.35, 0.2, 0.2]),
        "roughness2": 0.02,
        "bounce": np.array([0.3, 0.1, 0.1]),
        "whorl": np.zeros(3),
        "gloss": 0.9,
        "lit": 1.0,
    },
}


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """How a surface looks.

    Attributes:
        shader: "skin", "eye", "hair", "wet" or "plain": the fragment shader's name.
        texture: (H, W, 3 or 4) uint8; see the shader for what alpha means.
        values: Fixed uniforms of the shader, on top of DEFAULTS.
        two_sided: Also drawn from behind.
        blended: Mixed with what is behind it; drawn after all that is not.
        repeated: The texture goes on beyond its edges.
        in_mouth: Lit through the lips: a puppet sets the uniform `lit` by how far they open.
    """

    shader: str
    texture: U8
    values: Uniforms = field(default_factory=dict)
    two_sided: bool = False
    blended: bool = False
    repeated: bool = False
    in_mouth: bool = False

    def __post_init__(self) -> None:
        freeze(self, texture=(np.uint8, ("H", "W", "C")))


@dataclass(frozen=True, slots=True, eq=False)
class Lights:
    """Three distant lights and the light from all around, in the camera frame.

    Attributes:
        directions: (3, 3) from the subject towards the key, fill and rim light; any length.
        colors: (3, 3) linear RGB.
        ambient_above: (3,) linear RGB that reaches surfaces facing up.
        ambient_below: (3,) the same for surfaces facing down.
    """

    directions: FloatArray
    colors: FloatArray
    ambient_above: FloatArray
    ambient_below: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            directions=(np.float64, (3, 3)),
            colors=(np.float64, (3, 3)),
            ambient_above=(np.float64, (3,)),
            ambient_below=(np.float64, (3,)),
        )


def studio_lights() -> Lights:
    """Return a soft key light from the upper right, a cool fill and a rim from behind."""
    return Lights(
        np.array([[-0.55, -0.62, -0.75], [0.85, -0.15, -0.6], [0.75, -0.45, 0.75]]),
        np.array([[1.30, 1.20, 1.08], [0.30, 0.34, 0.42], [0.70, 0.74, 0.85]]),
        np.array([0.34, 0.36, 0.42]),
        np.array([0.20, 0.17, 0.16]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A camera, its clipping planes, and the quality of the picture.

    Attributes:
        camera: Exact pinhole camera; the picture has its size and its pixel centres.
        near_mm: Nearest distance drawn.
        far_mm: Furthest distance drawn.
        supersampling: 1, or 2 to draw at twice the size and average: for stills and films.
        mirrored: The picture is turned over, right for left; light from the left of the camera
            then falls from the right of the picture.
        samples: Per pixel, that a graphics card is asked for; 0 for none. It gives what it can.
    """

    camera: Camera
    near_mm: float = 40.0
    far_mm: float = 6000.0
    supersampling: int = 1
    mirrored: bool = False
    samples: int = 4

    def projection(self) -> FloatArray:
        """Return the matrix (4, 4) from the camera frame to OpenGL's clip space.

        The picture's first row lies at clip y = -1, where OpenGL starts to read, so that no
        picture is ever turned over in memory. Every triangle's sense of rotation turns over,
        and once more in a mirror.
        """
        width, height = self.camera.size_px
        focal, (x, y) = self.camera.focal_px, self.camera.center_px
        near, far = self.near_mm, self.far_mm
        depth = far - near
        side = -1 if self.mirrored else 1
        return np.array(
            [
                [side * 2 * focal / width, 0, side * ((2 * x + 1) / width - 1), 0],
                [0, 2 * focal / height, (2 * y + 1) / height - 1, 0],
                [0, 0, (far + near) / depth, -2 * far * near / depth],
                [0, 0, 1, 0],
            ]
        )


def placed(rotation: FloatArray, translation_mm: FloatArray) -> FloatArray:
    """Return the matrix (4, 4) of a rotation (3, 3) followed by a translation (3,)."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, translation_mm
    return matrix
