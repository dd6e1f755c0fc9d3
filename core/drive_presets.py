"""Settings to begin with, and faces for the keys."""

from dataclasses import replace

from core.arkit import EXPRESSION_NAMES
from core.drive_settings import (
    Centring,
    DriveSettings,
    ExpressionKey,
    EyeSettings,
    HeadMotion,
    IdleSettings,
    Response,
    Steadiness,
)
from core.setup_plan import coefficients

#: Faces by name; a coefficient without a side means both sides.
FACES: dict[str, dict[str, float]] = {
    "Smile": {"mouthSmile": 0.85, "cheekSquint": 0.45, "eyeSquint": 0.2, "mouthDimple": 0.2},
    "Laugh": {
        "mouthSmile": 0.9, "jawOpen": 0.4, "mouthUpperUp": 0.35, "cheekSquint": 0.7,
        "eyeSquint": 0.5, "browInnerUp": 0.2,
    },
    "Surprised": {
        "jawOpen": 0.45, "mouthFunnel": 0.2, "browInnerUp": 0.9, "browOuterUp": 0.8,
        "eyeWide": 0.85,
    },
    "Angry": {
        "browDown": 0.95, "noseSneer": 0.35, "eyeSquint": 0.35, "mouthPress": 0.5,
        "mouthFrown": 0.3,
    },
    "Sad": {
        "browInnerUp": 0.85, "mouthFrown": 0.75, "mouthShrugLower": 0.45, "eyeSquint": 0.2,
    },
    "Wink": {
        "eyeBlinkLeft": 1.0, "cheekSquintLeft": 0.6, "mouthSmileLeft": 0.5,
        "mouthSmileRight": 0.2,
    },
    "Kiss": {"mouthPucker": 0.95, "eyeBlink": 0.15, "browInnerUp": 0.15},
    "Puffed cheeks": {"cheekPuff": 0.95, "mouthPress": 0.3},
    "Eyes closed": {"eyeBlink": 1.0},
}  # fmt: skip


def face_key(name: str, hold: bool = False, way: str = "add") -> ExpressionKey:
    """Return the key of one of FACES."""
    return ExpressionKey(name, tuple(coefficients(FACES[name]).tolist()), hold, way)


#: What keys 1 to 9 show before the user changes them.
KEYS: tuple[ExpressionKey, ...] = tuple(
    face_key(name, way="part" if name == "Eyes closed" else "add") for name in FACES
)


def _gain(factor: float, *starts: str) -> tuple[Response, ...]:
    """Return responses with a gain for the coefficients whose names start so; () means all."""
    return tuple(
        Response(gain=factor) if not starts or name.startswith(starts) else Response()
        for name in EXPRESSION_NAMES
    )


_BASE = DriveSettings(keys=KEYS)

#: What can be chosen, by name, with what it is good for.
PRESETS: dict[str, tuple[str, DriveSettings]] = {
    "Natural": ("As you are: steady at rest, quick in motion", _BASE),
    "Lively": (
        "A little more of everything, for games and stories",
        replace(
            _BASE,
            steadiness=Steadiness(0.55, 0.55, 0.55, 0.6),
            responses=_gain(1.25, "mouth", "brow", "cheek", "jawOpen", "eyeWide", "noseSneer"),
            head=HeadMotion(1.15, 1.15, 1.15),
        ),
    ),
    "Calm": (
        "Quieter head and face, for lectures and meetings",
        replace(
            _BASE,
            steadiness=Steadiness(0.3, 0.3, 0.45, 0.45),
            responses=_gain(0.85, "brow", "mouthSmile", "mouthFrown", "cheek", "nose"),
            head=HeadMotion(0.7, 0.7, 0.7, 0.6, 0.6, 0.6),
        ),
    ),
    "Streamer close-up": (
        "The head stays in a small picture while you look around; the face does more",
        replace(
            _BASE,
            steadiness=Steadiness(0.4, 0.5, 0.5, 0.6),
            responses=_gain(1.15, "mouth", "brow"),
            head=HeadMotion(0.75, 0.8, 0.8, 0.4, 0.4, 0.3),
            centring=Centring(head=True),
            idle=IdleSettings(breathing="always"),
        ),
    ),
    "Cartoon": (
        "Everything large, for stylised avatars",
        replace(
            _BASE,
            responses=_gain(1.6),
            head=HeadMotion(1.35, 1.3, 1.4, 1.2, 1.2, 1.2),
            eyes=EyeSettings(gaze_gain=1.3),
        ),
    ),
    "As tracked": (
        "Nothing added, nothing taken off: to see what the tracker sees",
        DriveSettings(
            steadiness=Steadiness(1.0, 1.0, 1.0, 1.0),
            eyes=EyeSettings(link_lids="never", own_levels=False),
            idle=IdleSettings(breathing="never", blinking="never"),
            keys=KEYS,
        ),
    ),
}
