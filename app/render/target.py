"""The framebuffer that a picture is drawn into and read from."""

import moderngl
import numpy as np

from core.records import F32, U8


class Target:
    """Colour and depth of one size, multisampled where the graphics card does that."""

    def __init__(self, context: moderngl.Context, size_px: tuple[int, int], samples: int) -> None:
        self._context, self._size_px = context, size_px
        self.samples = samples
        self._plain = self._framebuffer(0)
        self._drawn = self._framebuffer(self.samples) if self.samples else self._plain

    def _framebuffer(self, samples: int) -> moderngl.Framebuffer:
        color = self._context.renderbuffer(self._size_px, 4, samples=samples)
        depth = self._context.depth_renderbuffer(self._size_px, samples=samples)
        return self._context.framebuffer([color], depth)

    def begin(self) -> None:
        """Draw here from now on, on nothing."""
        self._drawn.use()
        self.write_depth(True)
        self._drawn.clear(0.0, 0.0, 0.0, 0.0)

    def write_depth(self, on: bool) -> None:
        """Let what is drawn next hide what comes behind it, or not."""
        if self._drawn.depth_mask != on:
            self._drawn.depth_mask = on

    def end(self) -> None:
        """Average the samples of each pixel."""
        if self.samples:
            self._context.copy_framebuffer(self._plain, self._drawn)

    def read(self) -> U8:
        """Return the picture, (H, W, 4) uint8, its first row on top."""
        width, height = self._size_px
        picture = np.empty((height, width, 4), np.uint8)
        self._plain.read_into(picture, components=4)
        return picture

    def read_depth(self) -> F32:
        """Return OpenGL's depth in [0, 1], (H, W) float32, 1 where nothing was drawn."""
        width, height = self._size_px
        data = self._plain.read(components=1, attachment=-1, dtype="f4")
        return np.frombuffer(data, np.float32).reshape(height, width)

    def release(self) -> None:
        """Free it."""
        for framebuffer in {self._plain, self._drawn}:
            for part in (*framebuffer.color_attachments, framebuffer.depth_attachment):
                part.release()
            framebuffer.release()
