"""What landmark flow costs and how far it is off, for each way to choose when the network looks.

Run: python -m tests.benchmarks.bench_landmark_flow [--frames 300] [NAME ...]
A name is a video file, a real clip ("person_a_2"; FACEPUPPET_CLIPS names their folder) or a take
of the virtual performer ("talking"). --signs prints how well the expected error tells the true one.

Columns: share of frames with the network; processor ms per frame, and the median of a frame
without and of one with the network; then in px of a picture 640 wide, against the network in
every frame: RMS of the internal landmarks, its 95th percentile and worst frame, RMS of lids, lips
and pupils; correlation of the lids' opening, how deep blinks are (1 as by the network), jitter
(RMS second difference), and against the truth of a take: RMS about the mean error of each point.
"""

import argparse
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from app.capture.video import VideoSource
from app.performer.opening import Scenario, open_performer
from app.resources import asset
from core.aligner_bias import load_aligner_bias
from core.alignment import Alignment, FaceAligner
from core.flow_motion import face_size_px
from core.landmark_flow import FlowSettings, Followed, LandmarkFollower
from core.landmarks import GROUPS, N_INTERNAL
from core.records import FloatArray, Frame

USUAL = ("person_a_2", "person_a_1", "talking", "expressions", "head_turns", "fast_motion")
WAYS = (
    FlowSettings("every"), FlowSettings(2), FlowSettings(3), FlowSettings(5),
    FlowSettings(budget_ms=5.0), FlowSettings(budget_ms=7.0), FlowSettings(),
    FlowSettings(budget_ms=14.0),
)  # fmt: skip
_CLIPS = Path(__file__).resolve().parents[3] / "shared" / "clips"
_EYES = np.array([GROUPS["eye_right"], GROUPS["eye_left"]])
_LIPS = np.array([*GROUPS["lips_outer"], *GROUPS["lips_inner"]])
#: Eyes open less than this part of the usual are in a blink.
_BLINK = 0.4
_HEAD = (
    f"{'way':<14}{'share':>6}{'ms':>6}{'flow':>6}{'net':>6} |{'rms':>6}{'p95':>6}{'worst':>6}"
    f"{'lids':>6}{'lips':>6}{'pupil':>6}{'l.corr':>7}{'blink':>6}{'jitter':>7}{'truth':>6}"
)


@dataclass(frozen=True, slots=True, eq=False)
class Footage:
    """Frames of one source, what the network sees in each, and the truth if it is known.

    Attributes:
        name: Of the source.
        frames: All of one size, with a face in each.
        seen: By the network.
        truth_px: (N, 60, 2), NaN where it is not known.
    """

    name: str
    frames: list[Frame]
    seen: list[Alignment]
    truth_px: FloatArray


def load(name: str, n_frames: int, aligner: FaceAligner) -> Footage:
    """Return the frames of a source up to the first without a face."""
    path = Path(name)
    if not path.suffix:
        path = Path(os.environ.get("FACEPUPPET_CLIPS", _CLIPS)) / f"{name}.mp4"
    is_video = path.exists()
    source = VideoSource(path) if is_video else open_performer(Scenario(take=name))
    frames, seen, truth = [], [], []
    last = None
    with source:
        while len(frames) < n_frames and (frame := source.read()) is not None:
            last = aligner.follow(frame.rgb, last)
            if last is None:
                break
            frames.append(frame)
            seen.append(last)
            known = np.full((N_INTERNAL, 2), np.nan)
            truth.append(known if is_video else source.landmarks_px(frame.index)[:N_INTERNAL])
    return Footage(name, frames, seen, np.array(truth))


def points_of(landmarks: Sequence) -> FloatArray:
    return np.array([np.concatenate([one.points_px, one.pupils_px]) for one in landmarks])


def openings(points_px: FloatArray) -> FloatArray:
    """Return the mean opening of both eyes in parts of their width, (N,)."""
    outer, up, inner, low = (points_px[:, _EYES[:, k]] for k in (0, 2, 4, 6))
    wide = np.linalg.norm(outer - inner, axis=2)
    return np.mean(np.linalg.norm(up - low, axis=2) / wide, axis=1)


def blink_depth(openness: FloatArray, reference: FloatArray) -> float:
    """Return how far lids close where the reference's are closed, 1 for as far; NaN: nowhere."""
    usual = np.median(reference)
    closed = reference < _BLINK * usual
    if not closed.any():
        return float("nan")
    return float(np.mean(usual - openness[closed]) / np.mean(usual - reference[closed]))


def follow(
    footage: Footage, aligner: FaceAligner, settings: FlowSettings
) -> tuple[list[Followed], FloatArray]:
    """Return what was followed and the processor time of each frame in ms."""
    follower = LandmarkFollower(aligner, settings, time.process_time)
    followed, costs_ms = [], []
    for frame in footage.frames:
        start_s = time.process_time()
        one = follower.step(frame)
        costs_ms.append(1000 * (time.process_time() - start_s))
        if one is None:
            raise SystemExit(f"the face was lost in frame {frame.index} of {footage.name}")
        followed.append(one)
    return followed, np.array(costs_ms)


def row(footage: Footage, settings: FlowSettings, aligner: FaceAligner) -> str:
    followed, costs_ms = follow(footage, aligner, settings)
    looked = np.array([one.by_network for one in followed])
    points = points_of([one.landmarks for one in followed])
    seen = points_of([one.landmarks for one in footage.seen])
    scale = 640 / footage.frames[0].gray.shape[1]
    squares = scale**2 * np.sum((points - seen) ** 2, axis=2)
    frames = np.sqrt(squares[:, :N_INTERNAL].mean(axis=1))
    parts = [np.sqrt(squares[:, one].mean()) for one in (_EYES.ravel(), _LIPS, [75, 76])]
    shaking = np.diff(points[:, :N_INTERNAL], 2, axis=0)
    jitter = scale * np.sqrt(np.mean(np.sum(shaking**2, axis=2)))
    off = points[:, :N_INTERNAL] - footage.truth_px
    off = scale * (off - off.mean(axis=0))
    true = np.sqrt(np.mean(np.sum(off**2, axis=2)))
    lids, usual = openings(points), openings(seen)
    name = str(settings.detection)
    if name == "adaptive":
        name += f" {settings.budget_ms:g} ms"
    flow_ms = np.median(costs_ms[~looked]) if not looked.all() else np.nan
    return (
        f"{name:<14}{looked.mean():6.2f}{costs_ms.mean():6.1f}{flow_ms:6.1f}"
        f"{np.median(costs_ms[looked]):6.1f} |{np.sqrt(np.mean(frames**2)):6.2f}"
        f"{np.percentile(frames, 95):6.2f}{frames.max():6.2f}"
        f"{parts[0]:6.2f}{parts[1]:6.2f}{parts[2]:6.2f}{np.corrcoef(lids, usual)[0, 1]:7.3f}"
        f"{blink_depth(lids, usual):6.2f}{jitter:7.2f}{true:6.2f}"
    )


def sign_correlation(footage: Footage, aligner: FaceAligner, every: int) -> float:
    """Return how the logarithms of flow's expected and true error correlate."""
    followed, _ = follow(footage, aligner, FlowSettings(every))
    expected, true = [], []
    for one, seen in zip(followed, footage.seen, strict=True):
        if not one.by_network:
            internal = seen.landmarks.points_px[:N_INTERNAL]
            off = one.landmarks.points_px[:N_INTERNAL] - internal
            expected.append(one.error)
            true.append(np.sqrt(np.mean(np.sum(off**2, axis=1))) / face_size_px(internal))
    return float(np.corrcoef(np.log(expected), np.log(true))[0, 1])


def test_flow_costs_less_than_a_fifth_of_the_network():
    footage, aligner = _performer(60)
    shares = []
    for _ in range(3):
        followed, costs_ms = follow(footage, aligner, FlowSettings(2))
        looked = np.array([one.by_network for one in followed])
        extra_ms = np.median(costs_ms[looked]) - np.median(costs_ms[~looked])
        shares.append(np.median(costs_ms[~looked]) / extra_ms)
    assert min(shares) < 0.2


def test_adaptive_detection_stays_within_its_budget():
    footage, aligner = _performer(150)
    for budget_ms in (7.0, 9.0):
        settings = FlowSettings(budget_ms=budget_ms)
        followed, costs_ms = follow(footage, aligner, settings)
        looked = np.array([one.by_network for one in followed])
        saved_ms = 0.5 * settings.policy.savings * np.median(costs_ms[looked])
        assert np.mean(costs_ms) < 1.1 * budget_ms + 2 * saved_ms / len(costs_ms)


def _performer(n_frames: int) -> tuple[Footage, FaceAligner]:
    cv2.setNumThreads(1)
    aligner = _aligner()
    return load("talking", n_frames, aligner), aligner


def _aligner() -> FaceAligner:
    folder = asset("aligner")
    return FaceAligner(folder, load_aligner_bias(folder / "bias.npz"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", default=list(USUAL), metavar="NAME")
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--signs", action="store_true")
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    aligner = _aligner()
    for name in arguments.names:
        footage = load(name, arguments.frames, aligner)
        print(f"\n{name}: {len(footage.frames)} frames")
        if arguments.signs:
            for every in (4, 13):
                print(f"every {every}: {sign_correlation(footage, aligner, every):.3f}")
            continue
        print(_HEAD)
        for way in WAYS:
            print(row(footage, way, aligner), flush=True)


if __name__ == "__main__":
    main()
