"""The virtual performer as the person of a new profile."""

from collections.abc import Generator

import numpy as np

from app.performer.opening import SETUP, Scenario, open_performer
from app.performer.performer import FPS
from app.performer.prompts import setup_take
from app.setup_steps import Aligner, Pictures, unseen
from core.records import U8, Landmarks2D, Progress, SetupImages
from core.setup_plan import standard_for

#: Whom the live view's performances show, and in which room.
SCENARIO = Scenario(take=SETUP)


def film_performer(aligner: Aligner, every: int = 1) -> Generator[Progress, None, Pictures]:
    """Return setup pictures of the performer, with landmarks.

    Args:
        aligner: Finds the landmarks.
        every: Take only each so many-th of the 60 shots.
    """
    session = setup_take(SCENARIO.seed)
    names = session.names[::every]
    total, label = len(names), "Filming the virtual performer"
    rgbs: list[U8] = []
    landmarks: list[Landmarks2D] = []
    with open_performer(SCENARIO) as performer:
        for time_s in session.times_s[::every]:
            yield Progress(len(rgbs), total, label)
            rgb = performer.picture(round(float(time_s) * FPS)).rgb
            found = aligner.first(rgb)
            rgbs.append(rgb)
            landmarks.append(found.landmarks if found else unseen())
    standard = np.stack([standard_for(name) for name in names])
    return Pictures(SetupImages(tuple(rgbs), names, standard), tuple(landmarks), ())
