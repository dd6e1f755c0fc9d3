"""Draws scenes into pictures with OpenGL, offscreen."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import cv2
import moderngl
import numpy as np

from app.render.context import draws_in_software, finisher, make_context
from app.render.drawable import Drawable
from app.render.programs import surface_program
from app.render.scene import DEFAULTS, Lights, Material, Mesh, Uniforms, View
from app.render.target import Target
from core.kernels.antialias import gray_of, lay_over, mark_edges, smooth_edges
from core.records import F32, U8, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """A drawable at its place in one picture.

    Attributes:
        drawable: From `Renderer.upload`.
        head_to_camera: (4, 4).
        body_to_camera: (4, 4) for the vertices that the body holds.
        values: Uniforms of this picture, on top of the material's.
    """

    drawable: Drawable
    head_to_camera: FloatArray
    body_to_camera: FloatArray
    values: Uniforms = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """All that one picture shows.

    Attributes:
        view: The camera.
        lights: In the camera frame.
        items: Drawn in this order, those that blend last.
        backdrop: (H, W, 3) uint8 behind everything, of any size; None for transparency.
    """

    view: View
    lights: Lights
    items: Sequence[Item]
    backdrop: U8 | None = None


class Renderer:
    """Owns an OpenGL context; to be used and released in the thread that made it."""

    def __init__(self) -> None:
        self._context = make_context()
        self._finish = finisher(self._context)
        self.software = draws_in_software(self._context)
        self._programs: dict[str, moderngl.Program] = {}
        self._backdrop: tuple[U8, U8] | None = None
        self._targets: dict[tuple[int, int, int], Target] = {}

    def upload(self, mesh: Mesh, material: Material) -> Drawable:
        """Return the mesh on the graphics card, ready to be placed in scenes."""
        if material.shader not in self._programs:
            program = surface_program(self._context, material.shader)
            self._programs[material.shader] = program
        return Drawable(self._context, self._programs[material.shader], mesh, material)

    def draw(self, scene: Scene, scale: float = 1.0) -> U8:
        """Return the picture of a scene, (H, W, 4) uint8; colours are premultiplied by alpha.

        Args:
            scene: What to draw.
            scale: Below 1 saves time: the figure is drawn smaller by this factor and enlarged.
        """
        width, height = size = scene.view.camera.size_px
        factor = scene.view.supersampling * scale
        target = self._target((round(width * factor), round(height * factor)), scene.view.samples)
        self._paint(scene, target)
        self._finish()
        picture = target.read()
        if scene.view.supersampling == 1 and not target.samples:
            picture = _smoothed(picture)
        if picture.shape[1::-1] != size:
            how = cv2.INTER_AREA if factor > 1 else cv2.INTER_LINEAR
            picture = np.asarray(cv2.resize(picture, size, interpolation=how), np.uint8)
        if scene.backdrop is not None:
            lay_over(self._fitted(scene.backdrop, size), picture)
        return picture

    def depth_mm(self, scene: Scene) -> F32:
        """Return the distance along z of what is seen at each pixel, (H, W) float32 in mm.

        Infinite where nothing is. Of the same scene as `draw`, in a pass of its own.
        """
        target = self._target(scene.view.camera.size_px, scene.view.samples)
        self._paint(scene, target)
        self._finish()
        near, far = scene.view.near_mm, scene.view.far_mm
        clip = 2 * target.read_depth().astype(np.float64) - 1
        depth = 2 * near * far / (far + near - clip * (far - near))
        return np.where(clip >= 1, np.inf, depth).astype(np.float32)

    def release(self) -> None:
        """Free the context; nothing made by this renderer can be used afterwards."""
        self._context.release()

    def samples(self, asked: int) -> int:
        """Return how many samples per pixel there are where some are asked for."""
        return 0 if self.software else min(asked, self._context.max_samples)

    def _target(self, size_px: tuple[int, int], asked: int) -> Target:
        """Return the framebuffer of this size; two are kept, as for a film and a view."""
        samples = self.samples(asked)
        key = (*size_px, samples)
        target = self._targets.pop(key, None)
        if target is None:
            while len(self._targets) >= 2:
                self._targets.pop(next(iter(self._targets))).release()
            target = Target(self._context, size_px, samples)
        self._targets[key] = target
        return target

    def _paint(self, scene: Scene, target: Target) -> None:
        context = self._context
        target.begin()
        context.disable(moderngl.DEPTH_TEST | moderngl.CULL_FACE | moderngl.BLEND)
        context.enable(moderngl.DEPTH_TEST)
        # The projection turns pictures over, and with them every triangle.
        context.front_face = "ccw" if scene.view.mirrored else "cw"
        for program in {item.drawable.program for item in scene.items}:
            _set_view(program, scene)
        for item in sorted(scene.items, key=lambda item: item.drawable.material.blended):
            self._paint_item(item, target)
        target.end()

    def _paint_item(self, item: Item, target: Target) -> None:
        material = item.drawable.material
        context = self._context
        (context.disable if material.two_sided else context.enable)(moderngl.CULL_FACE)
        (context.enable if material.blended else context.disable)(moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        target.write_depth(not material.blended)
        program = item.drawable.program
        set_uniform(program, "head_to_camera", item.head_to_camera.T)
        set_uniform(program, "body_to_camera", item.body_to_camera.T)
        values = DEFAULTS[material.shader] | material.values | item.values
        for name, value in values.items():
            set_uniform(program, name, value)
        item.drawable.render()

    def _fitted(self, image: U8, size_px: tuple[int, int]) -> U8:
        """Return a backdrop at the picture's size; the last one is kept."""
        if image.shape[1::-1] == size_px:
            return image
        kept = self._backdrop
        if kept is None or kept[0] is not image or kept[1].shape[1::-1] != size_px:
            kept = image, cv2.resize(image, size_px, interpolation=cv2.INTER_AREA)
            self._backdrop = kept
        return kept[1]


def _smoothed(picture: U8) -> U8:
    """Return the picture with smooth edges, for drivers whose multisampling is too slow."""
    gray, out = np.empty(picture.shape[:2], np.uint8), picture.copy()
    marks = np.empty_like(gray)
    gray_of(picture, gray)
    mark_edges(gray, marks)
    smooth_edges(picture, gray, marks, out)
    return out


def _set_view(program: moderngl.Program, scene: Scene) -> None:
    directions = scene.lights.directions
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    set_uniform(program, "projection", scene.view.projection().T)
    set_uniform(program, "light_direction", unit)
    set_uniform(program, "light_color", scene.lights.colors)
    set_uniform(program, "ambient_above", scene.lights.ambient_above)
    set_uniform(program, "ambient_below", scene.lights.ambient_below)


def set_uniform(program: moderngl.Program, name: str, value: float | FloatArray) -> None:
    """Set a uniform, unless the driver dropped it because the shader does not use it.

    Drivers also drop the end of an array that is not read.
    """
    if name in program:
        uniform: Any = program[name]
        size = 4 * uniform.dimension * uniform.array_length
        uniform.write(np.asarray(value, np.float32).tobytes()[:size])
