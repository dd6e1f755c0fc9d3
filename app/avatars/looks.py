"""How a person looks apart from the shape of the head."""

from dataclasses import dataclass, replace

import numpy as np

from core.records import F32

#: Colours are (red, green, blue) in 0..255 as displayed.
Color = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Looks:
    """Colours and amounts; every amount is in [0, 1].

    Attributes:
        skin: Colour of the forehead in white light.
        lips: Colour of the lips.
        blush: Redness of cheeks, nose and ears.
        freckles: Freckles and small moles.
        age: Wrinkles, blotches and grey brows; 0 is about 20 years, 1 about 70.
        brows: Colour of the brows.
        brow_density: How thick the brows are.
        beard: Shadow of a beard.
        lashes: Strength of the lashes and of their dark line.
        iris: Main colour of the iris.
        hair: Colour of the hair.
        hair_style: "short", "cropped", "bob" or "bald".
        shirt: Colour of the shirt.
    """

    skin: Color = (214, 168, 142)
    lips: Color = (186, 108, 100)
    blush: float = 0.5
    freckles: float = 0.15
    age: float = 0.1
    brows: Color = (64, 44, 32)
    brow_density: float = 0.8
    beard: float = 0.0
    lashes: float = 0.8
    iris: Color = (92, 128, 150)
    hair: Color = (58, 40, 30)
    hair_style: str = "short"
    shirt: Color = (58, 78, 102)

    def changed(self, **values: object) -> "Looks":
        """Return these looks with some values replaced."""
        return replace(self, **values)  # type: ignore[arg-type]


_PORCELAIN = Looks(skin=(228, 188, 168), lips=(198, 118, 112), blush=0.65, freckles=0.45,
                   brows=(120, 84, 56), iris=(96, 140, 168), hair=(136, 92, 54))  # fmt: skip
_OLIVE = Looks(skin=(198, 148, 112), lips=(172, 98, 88), blush=0.4, brows=(44, 32, 26),
               iris=(112, 84, 44), hair=(38, 28, 24))  # fmt: skip
_BROWN = Looks(skin=(148, 100, 72), lips=(138, 80, 72), blush=0.3, brows=(34, 25, 22),
               iris=(84, 54, 30), hair=(28, 22, 20))  # fmt: skip
_DEEP = Looks(skin=(98, 64, 47), lips=(112, 66, 62), blush=0.2, freckles=0.05, brows=(24, 19, 18),
              iris=(62, 40, 26), hair=(20, 17, 17))  # fmt: skip

#: Looks to choose from, by name: five tones, young and old.
LOOKS: dict[str, Looks] = {
    "porcelain": _PORCELAIN,
    "light": Looks(),
    "olive": _OLIVE,
    "brown": _BROWN,
    "deep": _DEEP,
    "porcelain old": _PORCELAIN.changed(age=0.9, hair=(176, 172, 168), brows=(150, 140, 130)),
    "light old": Looks(age=0.9, hair=(150, 146, 142), brows=(120, 110, 102)),
    "olive old": _OLIVE.changed(age=0.9, hair=(130, 126, 124), brows=(96, 88, 82)),
    "brown old": _BROWN.changed(age=0.9, hair=(116, 112, 110), brows=(84, 78, 74)),
    "deep old": _DEEP.changed(age=0.9, hair=(110, 108, 108), brows=(80, 76, 74)),
}


def rgb(*values: float) -> F32:
    """Return numbers as an array of the type that colours are mixed in."""
    return np.array(values, np.float32)


def linear(color: Color) -> F32:
    """Return the linear value (3,) of a displayed colour; our gamma is 2."""
    return np.square(rgb(*color) / 255)
