"""The virtual performer as a source of frames, with the truth of every frame."""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field

import cv2
import numpy as np

from app.capture.source import ClosedOnExit
from app.performer.pacing import Pacer
from app.performer.sensor import Sensor, SensorSettings
from app.performer.stage import Setting, Stage
from app.performer.takes import Take
from app.performer.truth import Script
from core.camera import project
from core.evaluation import Truth
from core.records import U8, Camera, FloatArray, Frame

FPS = 30.0


@dataclass(frozen=True, slots=True)
class Filming:
    """How the performer is filmed.

    Attributes:
        seed: Of the noise.
        live: Frames come by the clock, unread ones are lost; else as fast as they are read.
        loop: The take starts again when it ends.
        blur_step_px: A moving picture is the mean of so many that none moves on by more.
        most_steps: But never of more.
        sensor: Of the webcam.
    """

    seed: int = 0
    live: bool = False
    loop: bool = False
    blur_step_px: float = 2.0
    most_steps: int = 4
    sensor: SensorSettings = field(default_factory=SensorSettings)


class VirtualPerformer(ClosedOnExit):
    """Plays a take; a FrameSource.

    OpenGL stays in one thread of its own, so frames may be read from any thread; unless live,
    that thread draws the next frame while the last one is looked at.
    """

    fps = FPS
    skips = False

    def __init__(self, take: Take, setting: Setting, filming: Filming | None = None) -> None:
        self._take, self._setting = take, setting
        self._filming = filming = filming or Filming()
        what = ", ".join((setting.person.name, take.name, *setting.conditions))
        self.name = f"virtual performer ({what})"
        self.size_px, self.live = setting.camera.size_px, filming.live
        usual_focal_px = setting.camera.focal_px * 640 / self.size_px[0]
        self._script = Script(take, setting.person, setting.model, usual_focal_px)
        self._sensor = Sensor(self.size_px, filming.sensor, filming.seed)
        self._pacer = Pacer(FPS)
        self._index = 0
        self._thread: ThreadPoolExecutor | None = ThreadPoolExecutor(max_workers=1)
        self._stage: Stage | None = None
        self._ahead: tuple[int, Future[Frame]] | None = None

    @property
    def camera(self) -> Camera:
        """The true camera of the pictures."""
        return self._setting.camera

    @property
    def n_frames(self) -> int:
        """Number of frames of the take, played once."""
        return int(self._take.duration_s * FPS)

    def read(self) -> Frame | None:
        """Return the next frame, None after the last one of a take that does not loop."""
        index = self._due() if self.live else self._index
        self._index = index + 1
        if self._thread is None or (index >= self.n_frames and not self._filming.loop):
            return None
        frame = self._claim(index).result()
        if not self.live and index + 1 < self.n_frames:
            self._ahead = index + 1, self._thread.submit(self._make, index + 1)
        return frame

    def seek(self, index: int) -> None:
        """Let the next frame be the one of this number, unless the take is live."""
        self._index = index

    def picture(self, index: int) -> Frame:
        """Return a frame out of turn."""
        return self._claim(index).result()

    def truth(self, index: int) -> Truth:
        """Return what is really there in the middle of a frame's exposure."""
        return self._script.truth(self._time_s(index))

    def landmarks_px(self, index: int) -> FloatArray:
        """Return where the 77 shape points are in a frame, (Q, 2)."""
        return project(self.camera, self.truth(index).points_mm)

    def close(self) -> None:
        """Free the renderer. May be called twice, from any thread."""
        if self._thread is not None:
            self._thread.submit(self._release)
            self._thread.shutdown()
        self._thread = self._ahead = None

    def _time_s(self, index: int) -> float:
        """Return the time in the take of a frame, which may be of a later round."""
        return float((index % self.n_frames) / FPS) if self._filming.loop else index / FPS

    def _due(self) -> int:
        """Wait for the next frame of a live take; its clock starts when all is set up."""
        if self._thread is not None and self._stage is None:
            self._thread.submit(self._build).result()
        return self._pacer.next_index()

    def _claim(self, index: int) -> "Future[Frame]":
        """Return the frame that is being made, or have it made."""
        if self._thread is None:
            raise ValueError(f"{self.name} is closed; open it again to see frame {index}")
        if self._ahead is not None and self._ahead[0] == index:
            return self._ahead[1]
        return self._thread.submit(self._make, index)

    def _make(self, index: int) -> Frame:
        """Return a frame; in the thread of the renderer only."""
        rgb = self._sensor.develop(self._exposed(self._time_s(index)), index / FPS, index)
        gray = np.asarray(cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY), np.uint8)
        return Frame(rgb, gray, index / FPS, index)

    def _exposed(self, time_s: float) -> U8:
        """Return the clean picture with the blur of what moves while the shutter is open."""
        exposure = self._filming.sensor.exposure_s
        ends = [
            project(self.camera, self._script.truth(time_s + share * exposure).points_mm)
            for share in (-0.5, 0.5)
        ]
        way_px = float(np.abs(ends[1] - ends[0]).max())
        steps = int(
            np.clip(np.ceil(way_px / self._filming.blur_step_px), 1, self._filming.most_steps)
        )
        shares = (np.arange(steps) + 0.5) / steps - 0.5
        if steps == 1:
            return self._clean(time_s)
        total = np.zeros((*self.size_px[::-1], 3), np.float32)
        for share in shares:
            cv2.accumulate(self._clean(time_s + share * exposure), total)
        return np.asarray(cv2.convertScaleAbs(total, alpha=1 / steps), np.uint8)

    def _clean(self, time_s: float) -> U8:
        truth = self._script.truth(time_s)
        posture = self._script.posture(time_s)
        return self._build().shoot(truth.expression, truth.gaze_rad, posture, time_s)

    def _build(self) -> Stage:
        if self._stage is None:
            self._stage = Stage(self._setting)
        return self._stage

    def _release(self) -> None:
        if self._stage is not None:
            self._stage.release()
        self._stage = None
