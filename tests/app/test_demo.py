"""The whole way, as a user goes it: film, set up, track, evaluate. Minutes, so it is one run."""

import json

import cv2
import numpy as np
import pytest

from app.commands.demo import OURS
from app.main import main
from core.arkit import ARKIT_NAMES, EXPRESSION_NAMES

N_FRAMES = 90


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    """The folder of a demo whose take is cut short."""
    folder = tmp_path_factory.mktemp("demo") / "out"
    assert main(["demo", "--out", str(folder), "--frames", str(N_FRAMES)]) == 0
    return folder


pytestmark = [pytest.mark.slow, pytest.mark.gl]


def test_the_demo_writes_all_it_says_and_tracks_every_frame(demo):
    assert {path.name for path in demo.iterdir()} == OURS
    report = json.loads((demo / "report.json").read_text(encoding="utf-8"))
    assert report["frames"] == N_FRAMES and report["lost"] == 0
    assert report["rmse_px"]["mean"] < 6
    assert report["rotation_deg"]["mean"] < 10
    assert report["setup"]["pictures"] >= 50
    assert len(list((demo / "setup").glob("*.png"))) == 60
    assert cv2.imread(str(demo / "frames.png")).shape == (3 * 480, 4 * 640, 3)


def test_the_profile_tracks_images_into_arrays_table_and_video(demo, tmp_path, capsys):
    outputs = [str(tmp_path / name) for name in ("t.npz", "t.csv", "t.mp4")]
    arguments = ["track", str(demo / "profile"), str(demo / "setup"), "--frames", "5", "--json"]
    arguments += ["--out", outputs[0], "--out", outputs[1], "--video", outputs[2]]
    assert main(arguments) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["frames"] == 5 and summary["written"] == outputs
    with np.load(outputs[0], allow_pickle=False) as track:
        assert tuple(track["expression_names"]) == EXPRESSION_NAMES
        assert tuple(track["arkit_names"]) == ARKIT_NAMES
        assert track["expression"].min() >= 0 and track["expression"].max() <= 1
        assert tuple(track["size_px"]) == (640, 480) and track["mode"] == "trained"
    assert len((tmp_path / "t.csv").read_text().splitlines()) == 6
    video = cv2.VideoCapture(outputs[2])
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == 5
    assert video.get(cv2.CAP_PROP_FRAME_WIDTH) == 2 * 640


def test_a_profile_is_evaluated_against_the_generic_aligner(demo, capsys):
    assert main(["evaluate", str(demo / "profile"), str(demo / "take.mp4"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["frames"] == N_FRAMES and report["compared"] > 0


def test_a_failing_track_leaves_an_older_one_alone(demo, tmp_path, capsys):
    older = tmp_path / "t.npz"
    older.write_bytes(b"older track")
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "a.png").write_bytes((demo / "frames.png").read_bytes())
    (tmp_path / "pictures" / "b.png").write_bytes(b"damaged")
    source = str(tmp_path / "pictures")
    assert main(["track", str(demo / "profile"), source, "--out", str(older)]) == 2
    assert "b.png" in capsys.readouterr().err
    assert older.read_bytes() == b"older track"
    assert {path.name for path in tmp_path.iterdir()} == {"t.npz", "pictures"}


def test_the_demo_refuses_a_folder_of_other_things(tmp_path, capsys):
    (tmp_path / "thesis.tex").write_text("years of work")
    assert main(["demo", "--out", str(tmp_path)]) == 2
    assert "holds other files (thesis.tex)" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]
