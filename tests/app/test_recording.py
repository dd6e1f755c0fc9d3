import csv
from dataclasses import replace

import cv2
import numpy as np
import pytest

from app.errors import OutputError
from app.recording.highlights import Highlights
from app.recording.outputs import DiskError, Outputs
from app.recording.table import HEADER, Table
from app.recording.track_file import TrackFile
from app.recording.video import SideBySideVideo, annotated, letterboxed
from core.arkit import ARKIT_NAMES, EXPRESSION_NAMES
from core.camera import camera_for
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.records import FaceState, Frame

SIZE = (64, 48)
CAMERA = camera_for(SIZE, 80.0)


def make_frame(index):
    rgb = np.full((SIZE[1], SIZE[0], 3), 100, np.uint8)
    return Frame(rgb, rgb[..., 0].copy(), index / 25, index)


def make_state(rng, index, lost=False):
    expression = np.zeros(46)
    expression[EXPRESSION_NAMES.index("jawOpen")] = 0.1 * index
    return FaceState(
        time_s=index / 25,
        rotation_wxyz=quaternion_from_matrix(matrix_from_head_angles(0.3, -0.1, 0.05)),
        translation_mm=[1.0, 2.0, 600.0],
        expression=expression,
        gaze_rad=np.full((2, 2), np.deg2rad(15)),
        shape_mm=rng.random((75, 3)),
        landmarks_px=rng.random((75, 2)) * SIZE,
        confidence=0.0 if lost else 0.9,
        mode="trained",
        lost=lost,
    )


def write(sink, rng, n_frames=3):
    with Outputs() as outputs:
        outputs.add(sink)
        for n in range(n_frames):
            outputs.write(make_frame(n), make_state(rng, n, lost=n == 2))


def test_track_file_holds_the_documented_arrays(tmp_path, rng):
    write(TrackFile(tmp_path / "t.npz", lambda: CAMERA), rng)
    with np.load(tmp_path / "t.npz", allow_pickle=False) as track:
        shapes = {name: track[name].shape for name in track.files}
        assert shapes == {
            "time_s": (3,), "lost": (3,), "confidence": (3,), "landmarks_px": (3, 75, 2),
            "shape_mm": (3, 75, 3), "rotation_wxyz": (3, 4), "translation_mm": (3, 3),
            "expression": (3, 46), "expression_names": (46,), "arkit": (3, 52),
            "arkit_names": (52,), "focal_px": (), "size_px": (2,), "mode": (),
        }  # fmt: skip
        assert track["lost"].tolist() == [False, False, True]
        assert track["mode"] == "trained" and track["focal_px"] == 80.0
        assert tuple(track["size_px"]) == SIZE
        np.testing.assert_allclose(track["time_s"], [0, 0.04, 0.08])
        jaw = list(track["arkit_names"]).index("jawOpen")
        np.testing.assert_allclose(track["arkit"][:, jaw], [0, 0.1, 0.2], rtol=1e-6)
        looks = list(track["arkit_names"]).index("eyeLookUpLeft")
        np.testing.assert_allclose(track["arkit"][:, looks], 0.5, rtol=1e-6)


def test_a_track_of_both_modes_tells_that_of_each_frame(tmp_path, rng):
    sink = TrackFile(tmp_path / "t.npz", lambda: CAMERA, "auto")
    with Outputs() as outputs:
        outputs.add(sink)
        for n, mode in enumerate(("free", "free", "trained")):
            outputs.write(make_frame(n), replace(make_state(rng, n), mode=mode))
    with np.load(tmp_path / "t.npz", allow_pickle=False) as track:
        assert track["mode"] == "auto"
        assert track["frame_mode"].tolist() == ["free", "free", "trained"]


def test_a_track_without_frames_has_the_same_arrays(tmp_path, rng):
    write(TrackFile(tmp_path / "t.npz", lambda: CAMERA), rng, n_frames=0)
    with np.load(tmp_path / "t.npz") as track:
        assert track["landmarks_px"].shape == (0, 75, 2)
        assert track["arkit"].shape == (0, len(ARKIT_NAMES))


def test_table_has_one_row_per_frame_under_its_header(tmp_path, rng):
    write(Table(tmp_path / "t.csv"), rng)
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["frame"] for row in rows] == ["0", "1", "2"]
    assert [row["lost"] for row in rows] == ["0", "0", "1"]
    assert tuple(rows[0]) == HEADER
    assert float(rows[1]["yaw_deg"]) == pytest.approx(np.rad2deg(0.3), abs=1e-3)
    assert float(rows[1]["pitch_deg"]) == pytest.approx(np.rad2deg(-0.1), abs=1e-3)
    assert (rows[1]["jawOpen"], rows[1]["arkit_jawOpen"], rows[1]["z_mm"]) == ("0.1", "0.1", "600")


def test_video_shows_source_and_avatar_side_by_side(tmp_path, rng):
    def draw_avatar(state):
        return np.full((96, 96, 4), (220, 30, 30, 255), np.uint8)

    write(SideBySideVideo(tmp_path / "v.mp4", 25.0, SIZE, draw_avatar), rng, n_frames=2)
    video = cv2.VideoCapture(str(tmp_path / "v.mp4"))
    found, picture = video.read()
    assert found and picture.shape == (48, 128, 3)
    # The square avatar stands in the middle of its half, black beside it.
    assert picture[24, 96, 2] > 150 and picture[24, 96, 1] < 90
    assert picture[24, 68].max() < 40
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == 2


def test_landmarks_are_drawn_and_a_lost_frame_has_none(rng):
    frame = make_frame(0)
    tracked, lost = (annotated(frame.rgb, make_state(rng, 0, lost)) for lost in (False, True))
    assert (tracked != frame.rgb).any()
    np.testing.assert_array_equal(lost[10:-10, 10:-10], frame.rgb[10:-10, 10:-10])
    assert lost[0, 0, 0] > 200 and frame.rgb[0, 0, 0] == 100


def test_letterbox_keeps_the_proportions():
    out = letterboxed(np.full((50, 100, 3), 255, np.uint8), (100, 100))
    assert (out[..., 0].max(axis=1) > 0).sum() == 50 and out[50].min() == 255


@pytest.mark.parametrize(
    "make",
    [
        lambda path: TrackFile(path, lambda: CAMERA),
        Table,
        lambda path: SideBySideVideo(path.with_suffix(".mp4"), 25.0, SIZE, lambda state: None),
    ],
)
def test_a_place_that_cannot_be_written_is_refused_at_once(tmp_path, make):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError, match="choose another place"):
        make(tmp_path / "file" / "t.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_folder_is_no_file_name(tmp_path):
    with pytest.raises(OutputError, match="is a folder"):
        Table(tmp_path)


def test_unknown_video_container_is_refused(tmp_path):
    with pytest.raises(OutputError, match=r"use \.mp4"):
        SideBySideVideo(tmp_path / "v.xyz", 25.0, SIZE, lambda state: None)
    assert list(tmp_path.iterdir()) == []


def test_an_error_on_the_way_leaves_older_files_as_they_were(tmp_path, rng):
    (tmp_path / "t.npz").write_bytes(b"older track")
    (tmp_path / "t.csv").write_bytes(b"older table")
    with pytest.raises(RuntimeError), Outputs() as outputs:
        outputs.add(TrackFile(tmp_path / "t.npz", lambda: CAMERA))
        outputs.add(Table(tmp_path / "t.csv"))
        outputs.write(make_frame(0), make_state(rng, 0))
        raise RuntimeError
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {
        "t.npz": b"older track",
        "t.csv": b"older table",
    }


def test_a_refused_output_takes_the_earlier_ones_back(tmp_path, rng):
    with pytest.raises(OutputError), Outputs() as outputs:
        outputs.add(Table(tmp_path / "t.csv"))
        outputs.add(Table(tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_told_in_words(tmp_path, rng):
    class Full:
        discarded = False

        def write(self, frame, state):
            raise OSError(28, "No space left on device")

        def discard(self):
            self.discarded = True

    full = Full()
    with pytest.raises(DiskError, match="no space left on device"), Outputs() as outputs:
        outputs.add(full)
        outputs.write(make_frame(0), make_state(rng, 0))
    assert full.discarded


def test_highlights_show_frames_spread_over_the_track_and_keep_the_states(tmp_path, rng):
    drawn = []

    def draw_avatar(state):
        drawn.append(state.time_s)
        return np.full((48, 64, 4), 200, np.uint8)

    highlights = Highlights(tmp_path / "h.png", SIZE, draw_avatar, 60)
    write(highlights, rng, n_frames=60)
    assert [round(25 * time_s) for time_s in drawn] == [5, 15, 25, 35, 45, 55]
    assert [state.time_s for state in highlights.states] == [n / 25 for n in range(60)]
    assert cv2.imread(str(tmp_path / "h.png")).shape == (3 * 48, 2 * 2 * 64, 3)


def test_highlights_of_nothing_leave_no_file(tmp_path, rng):
    write(Highlights(tmp_path / "h.png", SIZE, lambda state: None, 0), rng, n_frames=0)
    assert list(tmp_path.iterdir()) == []
