"""The face of a workbook before its first training: for the landmark editor."""

from collections.abc import Generator

import numpy as np

from app.workbook import Workbook
from core.blendshapes import user_blendshapes
from core.blind_pictures import rows_of_fit
from core.camera import camera_for
from core.face_model import FaceModel
from core.landmark_guess import guess_landmarks, placed_kept
from core.model_fit import FitSettings, fit_model
from core.pipeline import usable_pictures
from core.records import Camera, Progress, SetupImages, UserBlendshapes
from core.setup_plan import shot_of

#: Focal length of usual webcams over the width of their pictures.
FIRST_FOCAL = 0.95


def first_fit(
    model: FaceModel, book: Workbook
) -> Generator[Progress, None, tuple[Camera, UserBlendshapes]]:
    """Return the camera and the face of a workbook, roughly before its first training.

    Pictures of prompts in which no face was found get guessed landmarks.

    Raises:
        FewPicturesError: Too few pictures show a face.
    """
    if book.profile is not None:
        return book.profile.camera, book.profile.user
    given = book.used_names
    standard = np.stack([book.standard(name) for name in given])
    images = SetupImages(tuple(book.image(name) for name in given), given, standard)
    images, usable, sorting = usable_pictures(images, [book.landmarks(name) for name in given])
    height, width = images.images[0].shape[:2]
    camera = camera_for((width, height), FIRST_FOCAL * width)
    fit = yield from fit_model(model, camera, usable, FitSettings(), images.standard)
    user = user_blendshapes(model, fit)
    shots = [shot_of(name) for name in images.names]
    rows = [row for row, shot in enumerate(shots) if shot is not None]
    fitted = [shot for shot in shots if shot is not None]
    for name in (given[n] for n in sorting.guessed):
        shot = shot_of(name)
        if shot is not None:
            guess = guess_landmarks(model, user, camera, shot, fitted, rows_of_fit(fit, rows))
            book.suggest(name, placed_kept(guess, book.landmarks(name)))
    return camera, user
