"""Reads, joins and compiles the shaders."""

import re

import moderngl

from app.resources import shader

_INCLUDE = re.compile(r'^#include "([a-z_]+\.glsl)"$', re.MULTILINE)
#: Vertex attributes and their formats: those that move, those that stay.
MOVING = (("in_position", "3f"), ("in_normal", "3f"))
STAYING = (("in_uv", "2f"), ("in_extra", "4f"))


def source(name: str) -> str:
    """Return the text of a shader with its includes put in."""
    text = shader(name).read_text(encoding="utf-8")
    return _INCLUDE.sub(lambda match: source(match.group(1)), text)


def surface_program(context: moderngl.Context, material: str) -> moderngl.Program:
    """Return the program that draws meshes of one material."""
    return context.program(
        vertex_shader=source("surface.vert"), fragment_shader=source(f"{material}.frag")
    )


def layout(
    program: moderngl.Program, attributes: tuple[tuple[str, str], ...]
) -> tuple[str, list[str]]:
    """Return the buffer format and the names of the attributes that the program reads.

    A driver drops what a shader does not use; its bytes are then skipped.
    """
    used = [name for name, _ in attributes if name in program]
    parts = [form if name in program else f"{4 * int(form[0])}x" for name, form in attributes]
    return " ".join(parts), used
