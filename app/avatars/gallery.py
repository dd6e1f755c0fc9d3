"""The avatars to choose from: built in, and the user's own head."""

import json
from functools import cached_property
from pathlib import Path

import numpy as np

from app.avatars.build import Costume, Head, dressed
from app.avatars.characters import Character, drawn
from app.avatars.fennec import FENNEC
from app.avatars.juno import JUNO
from app.avatars.looks import LOOKS, Looks
from app.avatars.shaved import shaved
from app.avatars.wardrobe import AvatarFileError, Wardrobe, embellished, load_wardrobe
from app.render.avatar import Avatar
from core.face_model import FaceModel, deltas_mm, neutral_mm
from core.records import U8, FloatArray, UserBlendshapes

#: Looks of the built-in avatars, whose heads are in people.json.
_LOOKS: dict[str, Looks] = {
    "nora": LOOKS["porcelain"].changed(hair_style="bob"),
    "leo": LOOKS["light"].changed(beard=0.25, lashes=0.45, blush=0.35),
    "mei": LOOKS["light"].changed(
        skin=(220, 176, 146),
        hair=(28, 23, 22),
        brows=(36, 28, 26),
        iris=(78, 52, 32),
        hair_style="bob",
    ),
    "kofi": LOOKS["deep"].changed(hair_style="cropped", lashes=0.5, shirt=(120, 52, 46)),
    "amara": LOOKS["brown"].changed(hair_style="bob", shirt=(168, 128, 60)),
    "viktor": LOOKS["light old"].changed(beard=0.35, lashes=0.4, shirt=(70, 74, 70)),
}
#: The drawn characters; each has a picture of its skin in assets/avatars.
_CHARACTERS: dict[str, Character] = {"juno": JUNO, "fennec": FENNEC}


class Gallery:
    """Makes avatars of a face model; reads the shared files once, when first needed."""

    def __init__(self, assets: Path, model: FaceModel) -> None:
        """Remember where to read.

        Args:
            assets: The folder of shipped files: the parent of app.resources.asset("textures").
            model: The shipped face model.
        """
        self._assets, self._model = assets, model

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the built-in avatars, the first one the default."""
        return (*self._people, *_CHARACTERS)

    def built_in(self, name: str) -> Avatar:
        """Return a built-in avatar.

        Raises:
            KeyError: There is none of this name.
        """
        if name not in _CHARACTERS:
            return self.of_identity(self._people[name], _LOOKS.get(name, Looks()), name)
        character = _CHARACTERS[name]
        skin = self._assets / "avatars" / f"{name}.jpg"
        person = self._people[character.person]
        return drawn(character, self._model, person, self._wardrobe, skin, name)

    def of_user(
        self, user: UserBlendshapes, looks: Looks | None = None, skin: U8 | None = None
    ) -> Avatar:
        """Return the avatar with the user's own head and blendshapes.

        Args:
            user: Whose.
            looks: Colours and hair.
            skin: (S, S, 4) texture of the user's own skin, None for one painted by the looks.
        """
        head = Head(self._model, user.neutral_mm, user.deltas_mm)
        looks = looks or Looks()
        if skin is not None and looks.hair_style == "bald":
            skin = shaved(skin, self._wardrobe.skin_maps / "scalp.jpg", looks)
        costume = None if skin is None else Costume(skin)
        return dressed(head, looks, self._wardrobe, "you", costume)

    def of_identity(self, identity: FloatArray, looks: Looks, name: str) -> Avatar:
        """Return the avatar of any identity weights (I,) of the face model."""
        head = Head(
            self._model, neutral_mm(self._model, identity), deltas_mm(self._model, identity)
        )
        return dressed(head, looks, self._wardrobe, name)

    @cached_property
    def _wardrobe(self) -> Wardrobe:
        return embellished(load_wardrobe(self._assets, self._model), self._model)

    @cached_property
    def _people(self) -> dict[str, FloatArray]:
        path = self._assets / "avatars" / "people.json"
        try:
            people = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise AvatarFileError(path, str(error)) from error
        for name, weights in people.items():
            if len(weights) != self._model.n_identities:
                found = f"{len(weights)} weights for {name} where the face model has "
                raise AvatarFileError(path, f"{found}{self._model.n_identities}")
        return {name: np.array(weights, float) for name, weights in people.items()}
