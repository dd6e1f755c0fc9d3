"""What the landmark network sees of a film, kept, so that many trackers can be tried on it.

Drawing a performer and looking by the network cost a hundred times what solving a frame does.
"""

from collections.abc import Generator
from dataclasses import dataclass, field, replace

import numpy as np

from app.capture.source import FrameSource, expected_frames
from app.models import LEARNING_S, Models
from app.performer.opening import Scenario, open_performer
from core.energy_tracker import EnergySettings
from core.evaluation import Truth
from core.free_live import FreeSettings, FreeTracker
from core.landmark_flow import FlowSettings, Followed, LandmarkFollower
from core.landmarks import N_INTERNAL
from core.records import Camera, FaceState, FloatArray, Frame, Progress, UserBlendshapes


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """A film as trackers get it.

    Attributes:
        name: For people.
        size_px: (width, height).
        fps: Frames per second.
        times_s: (N,) time of each frame.
        seen: N times what the network saw; None where it saw no face.
        truths: N truths of a performer, none of others.
        camera: The true one of a performer, else None.
        reference_px: (N, 60, 2) internal landmarks of the generic aligner run on every frame by
            itself, NaN without a face; (0, 60, 2) if it was not asked for.
    """

    name: str
    size_px: tuple[int, int]
    fps: float
    times_s: FloatArray
    seen: tuple[Followed | None, ...]
    truths: tuple[Truth, ...]
    camera: Camera | None
    reference_px: FloatArray


class Replay:
    """Gives a tracker what was seen of each frame of a film."""

    def __init__(self, film: Film) -> None:
        self._film = film

    def step(self, frame: Frame) -> Followed | None:
        """Return what was seen of a frame."""
        return self._film.seen[frame.index]

    def reset(self) -> None:
        """Forget nothing: the film is what it is."""


def perform(scenario: Scenario, models: Models, most: int) -> Generator[Progress, None, Film]:
    """Film a performer and look at the film.

    Args:
        scenario: Who does what.
        models: The network is used.
        most: Frames at most.

    Yields:
        Progress, once per frame.
    """
    with open_performer(scenario) as source:
        film = yield from watch(source, models, most)
        truths = tuple(source.truth(n) for n in range(len(film.seen)))
        return replace(film, truths=truths, camera=source.camera)


def watch(
    source: FrameSource, models: Models, most: int, with_reference: bool = False
) -> Generator[Progress, None, Film]:
    """Look at every frame of a source.

    Args:
        source: Read from where it is.
        models: The network is used.
        most: Frames at most.
        with_reference: Also run the generic aligner on each frame by itself.

    Yields:
        Progress, once per frame.
    """
    follower = LandmarkFollower(models.aligner, FlowSettings("every"))
    seen: list[Followed | None] = []
    times, reference = [], []
    total = min(most, expected_frames(source) or most)
    while len(seen) < most and (frame := source.read()) is not None:
        seen.append(follower.step(frame))
        times.append(frame.time_s)
        if with_reference:
            alone = models.aligner.first(frame.rgb)
            unseen = np.full((N_INTERNAL, 2), np.nan)
            reference.append(alone.landmarks.points_px[:N_INTERNAL] if alone else unseen)
        yield Progress(len(seen), max(total, len(seen)), f"Watching {source.name}")
    return Film(
        source.name, source.size_px, source.fps, np.array(times), tuple(seen), (), None,
        np.array(reference).reshape(-1, N_INTERNAL, 2),
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Way:
    """How a film is tracked by the training-free mode.

    Attributes:
        known_focal: Whether the focal length is known.
        learn_first: The face is learned from the film's beginning, as `track` does with a
            recording; else on the way, as live.
        learn: Whether the face is learned at all.
        energy: How a frame is solved.
    """

    known_focal: bool = False
    learn_first: bool = True
    learn: bool = True
    energy: EnergySettings = field(default_factory=EnergySettings)


def track(film: Film, models: Models, way: Way) -> list[FaceState]:
    """Return the solved frames of a film."""
    tracker = tracker_for(film, models, way)
    return [tracker.step(frame) for frame in frames_of(film)]


def learned(film: Film, models: Models) -> UserBlendshapes:
    """Return the face of whoever is in the film, from its beginning, the camera known."""
    return tracker_for(film, models, Way(known_focal=True)).user


def tracker_for(film: Film, models: Models, way: Way) -> FreeTracker:
    """Return a tracker that is about to see the first frame of a film.

    Raises:
        ValueError: The focal length shall be known, but the film's is not.
    """
    if way.known_focal and film.camera is None:
        raise ValueError(f"the focal length of {film.name} is not known")
    camera = film.camera if way.known_focal else None
    settings = FreeSettings(energy=way.energy, learn=way.learn)
    tracker = FreeTracker(models.face_model, Replay(film), camera, settings)
    if way.learn and way.learn_first:
        for frame in frames_of(film)[: round(LEARNING_S * film.fps)]:
            tracker.step(frame)
        tracker.reset()
    return tracker


def frames_of(film: Film) -> list[Frame]:
    """Return the frames of a film without their pictures: their numbers, times and size."""
    width, height = film.size_px
    rgb, gray = np.zeros((height, width, 3), np.uint8), np.zeros((height, width), np.uint8)
    return [Frame(rgb, gray, float(time_s), n) for n, time_s in enumerate(film.times_s)]
