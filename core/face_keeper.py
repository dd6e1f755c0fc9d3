"""Stays with one face: the one that was followed so far, not the largest or the next best.

What is before it, a hand or somebody who passes by, is told by the colour of the skin, see
`core.cover_watch`. A face that is hidden is not followed, and neither is another's that the
network finds in its place. The detector looks for it meanwhile in the whole picture. Only when it
does not come back for some seconds another face is taken.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from core.alignment import Alignment
from core.cover_watch import CoverWatch, Judged
from core.landmarks import GROUPS, N_INTERNAL, N_LANDMARKS
from core.records import U8, FloatArray, Frame

_EYES = np.array([GROUPS["eye_right"], GROUPS["eye_left"]])


class Aligner(Protocol):
    """What is needed of the generic aligner."""

    def follow(self, rgb: U8, previous: Alignment | None) -> Alignment | None:
        """Return the face near the previous one, or after None the largest."""
        ...

    def check(self, rgb: U8, landmarks_px: FloatArray) -> Alignment | None:
        """Return what the network sees where a tracker says the face is."""
        ...


class SearchingAligner(Aligner, Protocol):
    """What is needed of it to find a face among others."""

    def faces(self, rgb: U8, near_px: FloatArray) -> Iterator[Alignment]:
        """Yield the faces in a picture, the nearest to a place first."""
        ...


class Seeing(Protocol):
    """Sees a face in frames, and what covers it."""

    @property
    def cover(self) -> FloatArray:
        """(75,) how far each landmark of the face that was seen last is covered."""
        ...

    @property
    def knows(self) -> bool:
        """Whether enough was seen of the face to tell what covers it; if not, look often."""
        ...

    def follow(self, frame: Frame, previous: Alignment | None) -> Alignment | None:
        """Return the face near the previous one, after None any."""
        ...

    def check(self, frame: Frame, landmarks_px: FloatArray) -> Alignment | None:
        """Return what is seen where a tracker says the face is."""
        ...


class Unwatched:
    """Sees by the aligner alone: nothing is ever covered, whoever is there is followed."""

    cover = np.zeros(N_LANDMARKS)
    knows = True

    def __init__(self, aligner: Aligner) -> None:
        self._aligner = aligner

    def follow(self, frame: Frame, previous: Alignment | None) -> Alignment | None:
        """Return the face near the previous one, after None the largest."""
        return self._aligner.follow(frame.rgb, previous)

    def check(self, frame: Frame, landmarks_px: FloatArray) -> Alignment | None:
        """Return what the network sees where a tracker says the face is."""
        return self._aligner.check(frame.rgb, landmarks_px)


@dataclass(frozen=True, slots=True)
class KeeperSettings:
    """How long a face is waited for.

    Attributes:
        patience_s: Time after which another face is taken.
        least_trust: Part of its confidence that a covered landmark keeps.
        sure: Mean cover of a face below which its place is remembered.
        covered: Mean cover from which on somebody else may take the face's place.
        wary_s: Time for which that is reckoned with.
        reach: Way from there to where the same face can be, in face sizes, at once and in a
            second; while somebody else is reckoned with; else.
        growth: Change of its scale that is possible at once and in a second, as a logarithm, alike.
        alike: Mean deviation below which it is the same face wherever it is, if half of its
            skin is to be seen, and change of its scale up to which that is believed.
    """

    patience_s: float = 2.5
    least_trust: float = 0.004
    sure: float = 0.08
    covered: float = 0.2
    wary_s: float = 1.0
    reach: tuple[tuple[float, float], tuple[float, float]] = ((0.2, 0.6), (1.0, 3.0))
    growth: tuple[tuple[float, float], tuple[float, float]] = ((0.1, 0.1), (0.15, 0.4))
    alike: tuple[float, float] = (0.85, 0.25)


class FaceKeeper:
    """Follows one face by the aligner; remembers what it looks like and where it was."""

    def __init__(
        self, aligner: SearchingAligner, watch: CoverWatch, settings: KeeperSettings | None = None
    ) -> None:
        self._aligner, self._watch = aligner, watch
        self._settings = settings or KeeperSettings()
        self._kept: Alignment | None = None
        self._cover = np.zeros(N_LANDMARKS)
        self._kept_s = self._sure_s = self._covered_s = -np.inf

    @property
    def cover(self) -> FloatArray:
        """(75,) how far each landmark of the face that was seen last is covered."""
        return self._cover

    @property
    def knows(self) -> bool:
        """Whether enough was seen of the face to tell what covers it."""
        return self._watch.knows

    @property
    def covered(self) -> float:
        """Mean of that over the internal landmarks."""
        return float(self._cover[:N_INTERNAL].mean())

    def check(self, frame: Frame, landmarks_px: FloatArray) -> Alignment | None:
        """Return what is seen where a tracker says the face is; None: not that face."""
        found = self._aligner.check(frame.rgb, landmarks_px)
        return None if found is None else self.judged(frame, found)

    def others(self, frame: Frame) -> Iterator[Alignment]:
        """Yield the faces in a frame beside the one that is followed."""
        if self._kept is None:
            return
        place, size_px = self._kept.region.center_px, _size_px(self._kept)
        for found in self._aligner.faces(frame.rgb, place):
            if np.linalg.norm(found.region.center_px - place) > 0.5 * size_px:
                yield found

    def forget(self) -> None:
        """Know no face: another person may be there, after a cut."""
        self._kept, self._kept_s, self._cover = None, -np.inf, np.zeros(N_LANDMARKS)
        self._watch.reset()

    def follow(self, frame: Frame, previous: Alignment | None) -> Alignment | None:
        """Return the face in a frame, covered landmarks with little confidence; None: not seen.

        Args:
            frame: The frame.
            previous: Where the face was, None if it was not followed.
        """
        impatient = not 0 <= frame.time_s - self._kept_s < self._settings.patience_s
        if self._kept is None or impatient:
            return self._anybody(frame, previous)
        found = self._aligner.follow(frame.rgb, previous or self._kept)
        own = None if found is None else self.judged(frame, found)
        return own or self._searched(frame, self._kept)

    def judged(self, frame: Frame, found: Alignment) -> Alignment | None:
        """Return what was found, covered landmarks with little confidence; None: it is hidden."""
        seen = self._watch.judge(frame.rgb, found.mesh_px, found.rotation, frame.time_s)
        if seen.hidden or not self._is_same(seen, found, frame.time_s):
            # Somebody is in the way: until that ends, nobody who comes up is trusted.
            self._covered_s = frame.time_s
            return None
        self._watch.accept(seen)
        self._kept_s, self._cover = frame.time_s, seen.cover
        cover = self.covered
        self._covered_s = frame.time_s if cover > self._settings.covered else self._covered_s
        if self._kept is None or cover < self._settings.sure:
            self._kept, self._sure_s = found, frame.time_s
        if not seen.cover.any():
            return found
        trust = 1.0 - (1.0 - self._settings.least_trust) * seen.cover
        marks = found.landmarks
        eyes = trust[_EYES].mean(axis=1)
        landmarks = replace(
            marks,
            confidence=marks.confidence * trust,
            pupil_confidence=marks.pupil_confidence * eyes,
        )
        return replace(found, landmarks=landmarks)

    def _is_same(self, seen: Judged, found: Alignment, time_s: float) -> bool:
        """Return whether a face can be the one that was surely seen last, by place or by looks."""
        settings, kept = self._settings, self._kept
        if kept is None or not self._watch.knows:
            return True
        calm = 0 if time_s - self._covered_s < settings.wary_s else 1
        since_s, before_px = time_s - self._sure_s, _size_px(kept)
        (reach, reach_s), (growth, growth_s) = settings.reach[calm], settings.growth[calm]
        way = float(np.linalg.norm(found.region.center_px - kept.region.center_px)) / before_px
        grown = abs(float(np.log(found.px_per_mm / kept.px_per_mm)))
        if way < reach + reach_s * since_s and grown < growth + growth_s * since_s:
            return True
        shown = float(seen.seen.mean()) > 0.5
        odd = float(seen.odd[:N_INTERNAL].mean())
        return shown and odd < settings.alike[0] and grown < settings.alike[1]

    def _anybody(self, frame: Frame, previous: Alignment | None) -> Alignment | None:
        """Return the face nearest to where one was, else the largest; get to know it if need be."""
        found = self._aligner.follow(frame.rgb, previous)
        if found is None:
            return None
        own = self.judged(frame, found)
        if own is not None:
            return own
        self.forget()
        return self.judged(frame, found)

    def _searched(self, frame: Frame, kept: Alignment) -> Alignment | None:
        """Return the known face wherever it is, None if it is not to be seen."""
        for found in self._aligner.faces(frame.rgb, kept.region.center_px):
            own = self.judged(frame, found)
            if own is not None:
                return own
        return None


def _size_px(found: Alignment) -> float:
    """Return the larger side of the box around the internal landmarks."""
    return float(np.ptp(found.landmarks.points_px[:N_INTERNAL], axis=0).max())
