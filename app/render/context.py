"""Makes an OpenGL context without a window."""

import ctypes
import ctypes.util
import sys
from collections.abc import Callable
from typing import Any

import moderngl

from app.errors import AppError

#: Drivers that draw on the CPU: multisampling costs them more than the whole picture.
SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "software", "gdi generic")


class RenderError(AppError):
    """No picture can be drawn on this machine."""

    def __init__(self, found: str) -> None:
        self.found = found
        super().__init__(
            f"cannot draw: making an OpenGL context gave '{found}'; expected OpenGL 3.3, by a "
            "graphics driver or in software: install the driver, or on Debian run "
            "'apt install libegl1 libgl1 libgl1-mesa-dri'"
        )


def make_context() -> moderngl.Context:
    """Return a context of OpenGL 3.3 for the calling thread, the only one that may use it.

    Raises:
        RenderError: The machine has no OpenGL.
    """
    options: dict[str, Any] = {"backend": "egl"} if sys.platform.startswith("linux") else {}
    try:
        return moderngl.create_context(standalone=True, require=330, **options)
    except Exception as error:  # glcontext raises nothing more special
        raise RenderError(str(error)) from error


def draws_in_software(context: moderngl.Context) -> bool:
    """Return whether the CPU draws, so that every pixel counts."""
    return any(word in context.info["GL_RENDERER"].lower() for word in SOFTWARE)


def finisher(context: moderngl.Context) -> Callable[[], None]:
    """Return a function that waits until all is drawn, without holding Python's lock.

    moderngl keeps the lock while it draws and reads back; a software driver draws late, in
    there. ctypes lets go of the lock during its call, so other threads run on.
    """
    names = {"win32": "opengl32", "darwin": "OpenGL"}
    loader = getattr(ctypes, "windll", ctypes.cdll) if sys.platform == "win32" else ctypes.cdll
    for name in (names.get(sys.platform, "GL"), "OpenGL"):
        path = ctypes.util.find_library(name)
        try:
            finish = loader.LoadLibrary(path or name).glFinish
        except (OSError, AttributeError):
            continue
        finish.restype, finish.argtypes = None, []
        return lambda: finish()
    return lambda: context.finish()
