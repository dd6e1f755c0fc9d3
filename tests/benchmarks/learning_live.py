"""Does the live view keep its frame rate while a profile learns a correction behind it?

    python -m tests.benchmarks.learning_live [FOLDER]

The virtual performer's frames are made beforehand and come by the clock, 30 per second. A profile
is kept in FOLDER, so that a second run is quick. Reported are frames solved per second, frames left
out, and wall time per step in the live thread: before a training, during it, and during one that
does not step back. The numbers are of this machine as it is loaded now; compare within one run.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import app  # noqa: F401  sets what numba reads first

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import numpy as np
from PySide6.QtCore import QCoreApplication

from app.capture.source import ClosedOnExit
from app.controllers import correction_tools
from app.controllers.correction_tools import Correction, CorrectionWorkshop
from app.controllers.toolbox import Toolbox
from app.performer.opening import Scenario, open_performer, setup_pictures
from app.profiles import encoded_pictures, profile_folder
from app.setup_steps import Pictures, make_profile, unseen
from app.workers.job import Job
from app.workers.live_loop import LiveLoop
from core.generations import HEADER_NAME
from core.records import Frame, SetupImages
from core.setup_plan import standard_for
from core.state_landmarks import confirmed
from core.store import save

NAME, PERSON, FPS = "bench", "mara", 30.0
SETTLING_S, MEASURED_S = 3.0, 12.0


class Film(ClosedOnExit):
    """Frames from memory, by the clock and without end; late ones are left out as by a webcam."""

    name, fps, live = "film", FPS, True

    def __init__(self, frames):
        self.frames, self.size_px = frames, frames[0].rgb.shape[1::-1]
        self.started_s, self.index = None, -1

    def read(self):
        now_s = time.perf_counter()
        self.started_s = now_s if self.started_s is None else self.started_s
        self.index = max(self.index + 1, int((now_s - self.started_s) * FPS))
        wait_s = self.started_s + self.index / FPS - now_s
        if wait_s > 0:
            time.sleep(wait_s)
        shown = self.frames[self.index % len(self.frames)]
        return Frame(shown.rgb, shown.gray, self.index / FPS, self.index)

    def close(self):
        self.started_s = None


def make(folder, toolbox):
    """Make the profile from the performer's setup pictures, unless it is there."""
    if (folder / HEADER_NAME).exists():
        return
    models = toolbox.models()
    shots = setup_pictures(Scenario(person=PERSON))
    names, rgbs = tuple(one[0] for one in shots), tuple(one[1].rgb for one in shots)
    found = [models.aligner.first(rgb) for rgb in rgbs]
    marks = tuple(one.landmarks if one else unseen() for one in found)
    images = SetupImages(rgbs, names, np.stack([standard_for(name) for name in names]))
    steps = make_profile(
        models.face_model, Pictures(images, marks, ()), 620.0, np.random.default_rng(1)
    )
    while True:
        try:
            next(steps)
        except StopIteration as end:
            profile, used = end.value
            break
    save(folder, profile, encoded_pictures(used))


class Watch:
    """What happens in the live thread."""

    def __init__(self, tracker):
        self.tracker, self.rows = tracker, []

    def step(self, frame):
        before_s = time.perf_counter()
        state = self.tracker.step(frame)
        now_s = time.perf_counter()
        self.rows.append((now_s, frame.index, 1000 * (now_s - before_s), state.mode == "trained"))
        return state, state

    def told(self, since_s, label):
        rows = np.array([row for row in self.rows if row[0] >= since_s])
        rate = (len(rows) - 1) / (rows[-1, 0] - rows[0, 0])
        dropped = int(np.sum(np.diff(rows[:, 1]) - 1))
        median, p95 = np.percentile(rows[:, 2], [50, 95])
        print(
            f"{label:28} {rate:5.1f} fps  {dropped:3d} of {len(rows) + dropped:3d} left out  "
            f"step {median:5.1f} ms median {p95:6.1f} ms p95  "
            f"{100 * rows[:, 3].mean():3.0f} % trained"
        )


def measure(watch, label, training=None):
    """Let some seconds pass and tell of them; a training that ends sooner ends the measurement."""
    since_s = time.perf_counter()
    while time.perf_counter() - since_s < MEASURED_S:
        QCoreApplication.processEvents()
        time.sleep(0.02)
        if training is not None and training.isFinished():
            break
    watch.told(since_s, label)


def main():
    kept = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp())
    os.environ["FACEPUPPET_HOME"] = str(kept)
    application = QCoreApplication([])
    toolbox = Toolbox()
    make(profile_folder(NAME), toolbox)
    with open_performer(Scenario("talking", PERSON)) as performer:
        frames = [performer.read() for _ in range(150)]
    watch = Watch(toolbox.open_profile(NAME).tracker)
    loop = LiveLoop(Film(frames), watch.step)
    loop.start()
    wait(SETTLING_S)
    measure(watch, "before")
    workshop = CorrectionWorkshop(toolbox)
    tracker = toolbox.open_profile(NAME).tracker
    state = [tracker.step(frame) for frame in frames[40:71]][-1]
    prepared = result_of(workshop.prepare(NAME, frames[70], state))
    book = prepared.book
    result_of(workshop.keep(Correction(NAME, frames[70].rgb, confirmed(book.now), book.found)))
    for label, back in (("during, stepping back", True), ("during, as it is", False)):
        learn(workshop, watch, label, back, wait_for_end=back)
    loop.stop()
    del application


def learn(workshop, watch, label, back, wait_for_end):
    original = correction_tools.stepping_back
    correction_tools.stepping_back = original if back else lambda steps: steps
    started_s = time.perf_counter()
    job = Job(workshop.train(NAME))
    ended = []
    job.returned.connect(ended.append)
    job.failed.connect(ended.append)
    job.start()
    wait(SETTLING_S)
    for part in range(1, 9):
        if job.isFinished() or (part > 2 and not wait_for_end):
            break
        measure(watch, f"{label} {part}", job)
    if wait_for_end:
        while not job.isFinished():
            wait(0.2)
        wait(0.2)
        print(f"the training took {time.perf_counter() - started_s:.0f} s:",
              getattr(ended[0], "text", ended[0]))  # fmt: skip
        watch.tracker = ended[0].performer.tracker
        since_s = time.perf_counter()
        wait(2.0)
        watch.told(since_s, "the new regressor")
    job.cancel()
    correction_tools.stepping_back = original


def wait(seconds):
    until_s = time.perf_counter() + seconds
    while time.perf_counter() < until_s:
        QCoreApplication.processEvents()
        time.sleep(0.02)


def result_of(steps):
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


if __name__ == "__main__":
    main()
