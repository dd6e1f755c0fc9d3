"""A mesh and its material on the graphics card."""

import moderngl
import numpy as np

from app.render.programs import MOVING, STAYING, layout
from app.render.scene import Material, Mesh
from core.records import F32


class Drawable:
    """Made by `Renderer.upload`; its vertices can be moved, the rest stays."""

    def __init__(
        self, context: moderngl.Context, program: moderngl.Program, mesh: Mesh, material: Material
    ) -> None:
        self.program, self.material = program, material
        moving = np.concatenate([mesh.vertices_mm, mesh.normals], axis=1)
        staying = np.concatenate([mesh.uv, mesh.extra], axis=1)
        self._moving = context.buffer(np.ascontiguousarray(moving), dynamic=True)
        self._staying = context.buffer(np.ascontiguousarray(staying))
        self._indices = context.buffer(np.ascontiguousarray(mesh.triangles))
        moving_form, moving_names = layout(program, MOVING)
        staying_form, staying_names = layout(program, STAYING)
        content = [
            (self._moving, moving_form, *moving_names),
            (self._staying, staying_form, *staying_names),
        ]
        self._array = context.vertex_array(program, content, self._indices)
        self._texture = _texture(context, material)

    def move(self, vertices_and_normals: F32) -> None:
        """Replace positions and normals, (V, 6) float32 in C order, in the mesh's order."""
        self._moving.write(vertices_and_normals)

    def render(self) -> None:
        """Draw with the uniforms as they are."""
        self._texture.use(0)
        self._array.render()

    def release(self) -> None:
        """Free what is on the graphics card."""
        for part in (self._array, self._moving, self._staying, self._indices, self._texture):
            part.release()


def _texture(context: moderngl.Context, material: Material) -> moderngl.Texture:
    height, width, channels = material.texture.shape
    data = np.ascontiguousarray(material.texture)
    texture = context.texture((width, height), channels, data, alignment=1)
    texture.build_mipmaps()
    # Blending two mipmap levels costs a software renderer a tenth of the picture.
    texture.filter = moderngl.LINEAR_MIPMAP_NEAREST, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = material.repeated
    return texture
