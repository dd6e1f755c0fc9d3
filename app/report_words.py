"""Why expressions will be weak, in words for somebody who only wants to stream."""

from collections.abc import Mapping, Sequence
from typing import Any

from app.picture_names import title_of

#: Expression -> what it is called, as a thing that an avatar does.
NAMES: dict[str, str] = {
    "eyeBlink": "blinking", "eyeSquint": "squinting", "eyeWide": "wide open eyes",
    "browDown": "lowered eyebrows", "browInnerUp": "raised inner eyebrows",
    "browOuterUp": "raised outer eyebrows", "cheekPuff": "puffed cheeks",
    "cheekSquint": "cheeks pushed up by a squint", "cheekSuck": "hollow cheeks",
    "noseSneer": "a wrinkled nose", "jawForward": "the jaw pushed forward",
    "jawLeft": "the jaw moved to the left", "jawRight": "the jaw moved to the right",
    "jawOpen": "an open mouth", "mouthClose": "lips closed over an open jaw",
    "mouthFunnel": "lips pushed forward and round", "mouthPucker": "a kissing mouth",
    "mouthLeft": "the mouth moved to the left", "mouthRight": "the mouth moved to the right",
    "mouthSmile": "smiling", "mouthFrown": "mouth corners pulled down",
    "mouthDimple": "dimples", "mouthStretch": "mouth corners pulled apart",
    "mouthRollLower": "the lower lip rolled in", "mouthRollUpper": "the upper lip rolled in",
    "mouthShrugLower": "the chin pushed up", "mouthShrugUpper": "the upper lip pushed up",
    "mouthPress": "pressed lips", "mouthLowerDown": "the lower lip pulled down",
    "mouthUpperUp": "the upper lip raised",
}  # fmt: skip


#: Mean error in % of the eye distance -> how good that is.
VERDICTS = (
    (2.5, "The training went well"),
    (5.0, "The training went fairly well; more pictures, or landmarks that you correct, make it "
          "better"),
)  # fmt: skip
POOR = "The training is not exact yet: look at the landmarks, and take the worst pictures again"
FREE = (
    ". Do not compare that with the training-free mode, whose points come from the very picture "
    "that it is tested on"
)
#: Fewer test pictures say little.
FEW_TESTS = 6


def verdict_words(held: Mapping[str, Any], compared: bool) -> str:
    """Return in one sentence how good a profile is.

    Args:
        held: Figures of the test.
        compared: Whether the report shows the training-free mode beside it.
    """
    share, n_tested = held["mean_percent_of_eye_distance"], held.get("pictures", 0)
    verdict = next((text for most, text in VERDICTS if share <= most), POOR)
    few = " – a rough figure, for so few pictures" if n_tested < FEW_TESTS else ""
    return (
        f"{verdict}: in {n_tested} pictures that it did not see, points are found within "
        f"{held['mean_rmse_px']:.1f} px on average ({share:.1f} % of the eye distance){few}"
        f"{FREE if compared else ''}."
    )


def face_words(face: str) -> str:
    """Return a prompted expression as people read it."""
    return "resting face" if face == "neutral" else face.replace("_", " ")


def weak_words(weak: Mapping[str, Any]) -> tuple[str, str]:
    """Return what will be weak, and why, as a text.

    Args:
        weak: One of the report's `weak_expressions`.
    """
    what = NAMES.get(without_side(weak["name"]), weak["name"])
    if weak["sides"] in ("left", "right"):
        what += f" on your {weak['sides']} side"
    return what[:1].upper() + what[1:], "; ".join(_reason(one) for one in weak["reasons"])


def without_side(name: str) -> str:
    """Return an expression's name as NAMES has it."""
    if name in NAMES:
        return name
    return name.removesuffix("Left").removesuffix("Right")


def _reason(reason: Mapping[str, Any]) -> str:
    kind = reason["kind"]
    if kind == "small":
        return (
            f"it moves no point of your face further than {reason['px']:.1f} px in your pictures, "
            "about as much as the points tremble"
        )
    if kind == "like":
        other = NAMES.get(without_side(reason["other"]), reason["other"])
        return f"on your face it looks nearly like {other}, and is often taken for it"
    if kind == "never asked":
        return "no picture asks for it, so an average face stands in for yours"
    quoted = [f"“{face_words(face)}”" for face in reason["faces"]]
    if kind == "missing":
        faces = _listed(quoted, "or")
        return f"no picture shows it clearly; take that of {faces} to make it yours"
    if kind == "unused":
        pictures = _listed([title_of(name) for name in reason["pictures"]])
        return f"{pictures} could not be used: too few points of the face were seen"
    share = round(10 * reason["share"])
    return (
        f"in your pictures of {_listed(quoted)} you made about {share} tenths of what was asked; "
        "take them again and overdo it, or raise its gain"
    )


def _listed(words: Sequence[str], last: str = "and") -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}"
