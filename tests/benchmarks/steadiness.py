"""How steady the driven face is when nothing moves, and how late when everything does.

Virtual performers are filmed and tracked frame by frame as live; "trained" makes a profile from
their setup pictures first. The tracks, and with --clip that of a video, are then driven by each
preset. "solved" is what the tracker gives.

statue   standard deviation over the take: head angles (worst of three, degrees), place (worst of
         x and y, mm), coefficients (mean and worst); then the noise from frame to frame of the same
lag      ms by which head angles, blinks and jaw come after the solved ones, by the shift of best
         correlation ("solved": after the truth)
lids     of all frames in which an eye is really closed (open): the mean of its coefficient, and the
         share of frames in which it is at least 0.95 (at most 0.05)
peaks    how much of each blink and of each opening of the jaw is let through, in parts of the
         solved one: median and worst of all, and of the shortest ones

Run: python -m tests.benchmarks.steadiness [--people NAME ...] [--modes trained free]
         [--tracks FOLDER] [--clip VIDEO]
"""

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.capture.video import VideoSource
from app.models import Looking, free_tracker, live_tracker, load_models
from app.performer.opening import PEOPLE, Scenario, open_performer, setup_pictures
from app.setup_steps import Pictures, make_profile, unseen
from app.studies.measures import head_angles_deg, shake
from core.arkit import EXPRESSION_NAMES
from core.blink_levels import BlinkLevels, blink_levels
from core.drive import Drive
from core.drive_presets import PRESETS
from core.drive_settings import EyeSettings
from core.evaluation import jitter
from core.live import resting_state
from core.records import FaceState, SetupImages
from core.setup_plan import standard_for
from tests.synthetic_face import finish

TAKES = {"statue": 200, "talking": 450, "head_motion": 200, "mixed": 700}
#: A head of a film that turns slower is still.
STILL_DEG_S = 3.0
#: The first frames, in which filters settle and a face is learned, do not count.
SETTLING = 20
JAW = EXPRESSION_NAMES.index("jawOpen")
BLINKS = [EXPRESSION_NAMES.index("eyeBlink" + side) for side in ("Right", "Left")]
KEPT = ("time_s", "rotation_wxyz", "translation_mm", "expression", "gaze_rad", "confidence", "lost")
TRUE = ("rotation_wxyz", "expression")


# -- tracks ---------------------------------------------------------------------------------


def profile_of(models, person):
    shots = setup_pictures(Scenario(person=person))
    names = tuple(name for name, _, _ in shots)
    rgbs = tuple(frame.rgb for _, frame, _ in shots)
    found = [models.aligner.first(rgb) for rgb in rgbs]
    landmarks = tuple(one.landmarks if one else unseen() for one in found)
    images = SetupImages(rgbs, names, np.stack([standard_for(name) for name in names]))
    rng = np.random.default_rng(1)
    return finish(make_profile(models.face_model, Pictures(images, landmarks, ()), None, rng))[0]


def track(source, tracker, most):
    """Return the solved states of a source, and its truth where it has one, as arrays."""
    states, truths = [], []
    while len(states) < most and (frame := source.read()) is not None:
        states.append(tracker.step(frame))
        if hasattr(source, "truth"):
            truths.append(source.truth(frame.index))
    arrays = {name: np.array([getattr(one, name) for one in states]) for name in KEPT}
    return arrays | {"true_" + k: np.array([getattr(t, k) for t in truths]) for k in TRUE}


def make_tracks(folder, people, modes, clip):
    """Write the tracks that are not there yet."""
    models = load_models()
    ways = {"free": lambda _: free_tracker(models, looking=Looking("adaptive"))}
    for person in people:
        missing = [
            (mode, take)
            for mode in modes
            for take in TAKES
            if not (folder / f"{person}_{take}_{mode}.npz").exists()
        ]
        levels = None
        if any(mode == "trained" for mode, _ in missing):
            profile = profile_of(models, person)
            levels = blink_levels(profile.standard, profile.shapes.coefficients)
            ways["trained"] = lambda _, profile=profile: live_tracker(models, profile)
        for mode, take in missing:
            with open_performer(Scenario(take, person)) as source:
                arrays = track(source, ways[mode](person), TAKES[take])
            if mode == "trained" and levels is not None:
                arrays["levels"] = np.array([levels.open, levels.closed])
            np.savez(folder / f"{person}_{take}_{mode}.npz", **arrays)
    if clip is not None and not (folder / f"{clip.stem}_clip_free.npz").exists():
        with VideoSource(clip) as source:
            np.savez(folder / f"{clip.stem}_clip_free.npz", **track(source, ways["free"](""), 800))


def states_of(arrays):
    """Return the solved states of a track."""
    still = resting_state("trained")
    rows = zip(*(arrays[name] for name in KEPT), strict=True)
    return [
        FaceState(
            float(time_s), rotation, place, expression, gaze, still.shape_mm, still.landmarks_px,
            float(confidence), "trained", bool(lost),
        )
        for time_s, rotation, place, expression, gaze, confidence, lost in rows
    ]  # fmt: skip


def driven(states, settings):
    drive = Drive(settings)
    return [drive.step(state) for state in states]


# -- measures -------------------------------------------------------------------------------


def values(states, name):
    return np.array([getattr(state, name) for state in states])


def angles(states):
    return np.array([head_angles_deg(state.rotation_wxyz) for state in states])


def stillness(states):
    """Return eight figures, see above."""
    states = states[SETTLING:]
    turns, places = angles(states), values(states, "translation_mm")[:, :2]
    faces = values(states, "expression")
    figures = []
    for spread in (lambda a: a.std(axis=0), shake):
        figures += [spread(turns).max(), spread(places).max()]
        figures += [spread(faces).mean(), spread(faces).max()]
    return figures


def lag_ms(times_s, early, late, most_ms=150):
    """Return by how much a signal comes after another, by their best correlation."""
    grid = np.arange(times_s[0], times_s[-1], 1e-3)
    a, b = (np.interp(grid, times_s, signal) for signal in (early, late))
    inner = slice(most_ms, len(grid) - most_ms)
    scores = [
        np.corrcoef(a[inner], b[most_ms + ms : len(grid) - most_ms + ms])[0, 1]
        for ms in range(-most_ms // 3, most_ms)
    ]
    return float(np.argmax(scores) - most_ms // 3)


def peaks(signal, after, least=0.3):
    """Return for each rise and fall of a signal (height, frames above half, part let through)."""
    found, k = [], 1
    while k < len(signal) - 1:
        if signal[k] < least or signal[k] < signal[k - 1] or signal[k] < signal[k + 1]:
            k += 1
            continue
        begin = end = k
        while begin > 0 and signal[begin - 1] > 0.5 * signal[k]:
            begin -= 1
        while end < len(signal) - 1 and signal[end + 1] > 0.5 * signal[k]:
            end += 1
        top = signal[begin : end + 1].max()
        # What is let through may come late, but not after the next rise.
        through = after[begin : min(end + 4, len(after))].max()
        found.append((top, end - begin + 1, min(through / top, 1.5)))
        k = end + 1
    return np.array(found).reshape(-1, 3)


def let_through(pairs, columns):
    """Return count, median and worst part of all peaks, median and worst of the shortest ones."""
    found = np.concatenate([
        peaks(values(before, "expression")[:, c], values(after, "expression")[:, c])
        for before, after in pairs
        for c in columns
    ])  # fmt: skip
    if not len(found):
        return [0, np.nan, np.nan, np.nan, np.nan]
    short = found[found[:, 1] <= 4, 2]
    short = short if len(short) else np.array([np.nan])
    parts = found[:, 2]
    return [len(found), np.median(parts), parts.min(), np.median(short), short.min()]


# -- report ---------------------------------------------------------------------------------


def line(name, figures, form):
    print(f"{name:26s}" + "".join(format(figure, form).rjust(9) for figure in figures))


def report(folder, people, mode):
    tracks = {
        (person, take): dict(np.load(folder / f"{person}_{take}_{mode}.npz"))
        for person in people
        for take in TAKES
    }
    solved = {key: states_of(arrays) for key, arrays in tracks.items()}
    presets = {"solved": None} | {name: preset for name, (_, preset) in PRESETS.items()}
    shown = {
        name: {k: s if preset is None else driven(s, plain(preset)) for k, s in solved.items()}
        for name, preset in presets.items()
    }
    print(f"\n{mode}, statue: angle mm face face-max, frame to frame: angle mm face face-max")
    for name, by_take in shown.items():
        line(name, np.mean([stillness(by_take[p, "statue"]) for p in people], axis=0), ".4f")
    print(f"\n{mode}, lag ms: yaw, pitch (head_motion) blink jaw (talking)")
    for name, by_take in shown.items():
        line(name, np.mean([lags(tracks, solved, by_take, p) for p in people], axis=0), ".0f")
    print(f"\n{mode}, peaks: blinks: count median worst, short: median worst; the same of the jaw")
    for name, by_take in shown.items():
        if name != "solved":
            pairs = [(solved[k], by_take[k]) for k in solved if k[1] in ("talking", "mixed")]
            line(name, [*let_through(pairs, BLINKS), *let_through(pairs, [JAW])], ".2f")

    print(f"\n{mode}, lids: closed: mean, share >= 0.95; open: mean, share <= 0.05")
    for name in ("as tracked", "levels learned on the way", "levels of the profile"):
        if name != "levels of the profile" or mode == "trained":
            line(name, lids(tracks, solved, people, name), ".3f")


def lids(tracks, solved, people, way):
    """Return four figures, see above, over the takes with blinks."""
    eyes = EyeSettings(own_levels=way != "as tracked", link_lids="never")
    settings = replace(PRESETS["Natural"][1], eyes=eyes)
    found, true = [], []
    for key in ((person, take) for person in people for take in ("talking", "mixed")):
        drive = Drive(settings)
        if way == "levels of the profile":
            drive.know_levels(BlinkLevels(*tracks[key]["levels"]))
        found.append(values([drive.step(state) for state in solved[key]], "expression")[:, BLINKS])
        true.append(tracks[key]["true_expression"][:, BLINKS])
    found, true = np.concatenate(found), np.concatenate(true)
    shut, wide = found[true > 0.9], found[true < 0.1]
    return [shut.mean(), (shut >= 0.95).mean(), wide.mean(), (wide <= 0.05).mean()]


def plain(preset):
    """Return the filters of a preset alone: gains and links are not what is measured."""
    return replace(PRESETS["As tracked"][1], steadiness=preset.steadiness)


def lags(tracks, solved, by_take, person):
    figures = []
    for take, column in (("head_motion", 2), ("head_motion", 1)):
        arrays, own = tracks[person, take], by_take[person, take]
        is_solved = own is solved[person, take]
        true = np.array([head_angles_deg(q) for q in arrays["true_rotation_wxyz"]])
        before = true if is_solved else angles(solved[person, take])
        figures.append(lag_ms(arrays["time_s"], before[:, column], angles(own)[:, column]))
    arrays, own = tracks[person, "talking"], by_take[person, "talking"]
    for column in (BLINKS[0], JAW):
        is_solved = own is solved[person, "talking"]
        before = arrays["true_expression"] if is_solved else arrays["expression"]
        after = values(own, "expression")
        figures.append(lag_ms(arrays["time_s"], before[:, column], after[:, column]))
    return figures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--people", nargs="+", choices=PEOPLE, default=["mara"])
    parser.add_argument("--modes", nargs="+", choices=("trained", "free"), default=["trained"])
    parser.add_argument("--tracks", type=Path, help="keep the tracks in this folder")
    parser.add_argument("--clip", type=Path, help="also a video, tracked without a profile")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        folder = args.tracks or Path(made)
        folder.mkdir(parents=True, exist_ok=True)
        make_tracks(folder, args.people, args.modes, args.clip)
        for mode in args.modes:
            report(folder, args.people, mode)
        if args.clip is not None:
            report_clip(folder / f"{args.clip.stem}_clip_free.npz")
    return 0


def still_frames(turns, times_s):
    """Return where a head turns by less than STILL_DEG_S, half a second about each frame."""
    span = np.ones(2 * round(0.25 / np.median(np.diff(times_s))) + 1)
    smooth = np.array([np.convolve(one, span / span.sum(), mode="same") for one in turns.T]).T
    return np.abs(np.gradient(smooth, times_s, axis=0)).max(axis=1) < STILL_DEG_S


def report_clip(path):
    """Print what presets do to the track of a film without truth."""
    arrays = dict(np.load(path))
    solved, times_s = states_of(arrays), arrays["time_s"]
    still = still_frames(angles(solved), times_s) & ~arrays["lost"]
    presets = {"solved": None} | {name: preset for name, (_, preset) in PRESETS.items()}
    print(f"\n{path.stem}: noise from frame to frame of angles (degrees) and face in the "
          f"{still.sum()} frames of a still head; lag of yaw and jaw (ms); blinks: median, worst "
          "part let through; the same of the jaw")  # fmt: skip
    for name, preset in presets.items():
        own = solved if preset is None else driven(solved, plain(preset))
        turns, faces = angles(own), values(own, "expression")
        figures = [max(jitter(one, still) for one in turns.T)]
        figures += [np.mean([jitter(one, still) for one in faces.T])]
        figures += [lag_ms(times_s, angles(solved)[:, 2], turns[:, 2])]
        figures += [lag_ms(times_s, values(solved, "expression")[:, JAW], faces[:, JAW])]
        figures += let_through([(solved, own)], BLINKS)[1:3]
        figures += let_through([(solved, own)], [JAW])[1:3]
        line(name, figures, ".4f")


if __name__ == "__main__":
    sys.exit(main())
