import cv2
import numpy as np
import pytest

from app.capture.choose import camera_number, open_source
from app.capture.folder import FolderSource, setup_pictures
from app.capture.source import fit_to
from app.capture.video import VideoSource
from app.capture.webcam import CameraEntry, WebcamSource
from app.errors import (
    CameraBusyError,
    CameraLostError,
    ImageSizesError,
    NoCameraError,
    NoImagesError,
    SourceMissingError,
    SourceUnreadableError,
)


def write_video(path, n_frames=6, size=(64, 48), fps=25.0):
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), fps, size)
    for n in range(n_frames):
        writer.write(np.full((size[1], size[0], 3), (10 * n, 60, 200), np.uint8))
    writer.release()
    return path


def write_image(path, value=128, size=(64, 48)):
    cv2.imwrite(str(path), np.full((size[1], size[0], 3), value, np.uint8))
    return path


def frames_of(source):
    with source:
        return list(iter(source.read, None))


class FakeDevice:
    """Stands for cv2.VideoCapture: gives these pictures, then fails."""

    def __init__(self, pictures, opened=True):
        self.pictures, self.opened, self.released = list(pictures), opened, False

    def read(self):
        return (True, self.pictures.pop(0)) if self.pictures else (False, None)

    def isOpened(self):
        return self.opened

    def set(self, *_):
        return True

    def get(self, _):
        return 0.0

    def release(self):
        self.released = True


ONE_CAMERA = (CameraEntry(0, "Laptop camera", ""),)


def test_video_gives_every_frame_in_rgb_with_its_time(tmp_path):
    source = VideoSource(write_video(tmp_path / "a.mp4"))
    frames = frames_of(source)
    assert (source.size_px, source.fps, source.live) == ((64, 48), 25.0, False)
    assert [frame.index for frame in frames] == list(range(6))
    np.testing.assert_allclose([frame.time_s for frame in frames], np.arange(6) / 25, atol=1e-6)
    assert frames[0].rgb[20, 20, 0] > 150 > frames[0].rgb[20, 20, 2]
    assert frames[0].gray.shape == (48, 64)
    assert not source.cut_short()


def test_closed_video_gives_nothing(tmp_path):
    source = VideoSource(write_video(tmp_path / "a.mp4"))
    source.close()
    assert source.read() is None


def test_missing_video_says_what_was_looked_for(tmp_path):
    with pytest.raises(SourceMissingError, match=r"no\.mp4.*check the spelling"):
        open_source(str(tmp_path / "no.mp4"))


def test_empty_video_is_told_from_a_damaged_one(tmp_path):
    empty, damaged = tmp_path / "empty.mp4", tmp_path / "damaged.mp4"
    empty.write_bytes(b"")
    damaged.write_bytes(write_video(tmp_path / "a.mp4").read_bytes()[:300])
    with pytest.raises(SourceUnreadableError, match="empty file"):
        VideoSource(empty)
    with pytest.raises(SourceUnreadableError, match="300 bytes that are no video"):
        VideoSource(damaged)


def test_video_that_stops_early_is_noticed(tmp_path):
    path = tmp_path / "a.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25, (64, 48))
    noise = np.random.default_rng(0)
    for _ in range(40):
        writer.write(noise.integers(0, 255, (48, 64, 3), dtype=np.uint8))
    writer.release()
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    source = VideoSource(path)
    assert 0 < sum(1 for _ in iter(source.read, None)) < 40
    assert source.cut_short()


def test_folder_shows_pictures_in_natural_order(tmp_path):
    for number, value in ((10, 200), (2, 20), (1, 10)):
        write_image(tmp_path / f"shot{number}.png", value)
    (tmp_path / "notes.txt").write_text("not a picture")
    frames = frames_of(FolderSource(tmp_path, fps=10))
    assert [int(frame.gray[0, 0]) for frame in frames] == [10, 20, 200]
    assert [frame.time_s for frame in frames] == [0.0, 0.1, 0.2]


def test_folder_without_images_names_what_it_takes(tmp_path):
    (tmp_path / "notes.txt").write_text("not a picture")
    with pytest.raises(NoImagesError, match=r"no images.*\.png, \.jpg"):
        open_source(str(tmp_path))


@pytest.mark.parametrize("content", [b"", b"no picture at all"])
def test_damaged_picture_is_named(tmp_path, content):
    write_image(tmp_path / "a.png")
    (tmp_path / "b.png").write_bytes(content)
    with pytest.raises(SourceUnreadableError, match=r"b\.png"):
        frames_of(FolderSource(tmp_path))


def test_setup_pictures_must_be_of_one_size(tmp_path):
    write_image(tmp_path / "a.png")
    write_image(tmp_path / "b.png", size=(32, 48))
    with pytest.raises(ImageSizesError, match=r"a is 64x48|a\.png is 64x48, b\.png is 32x48"):
        setup_pictures(tmp_path)


def test_setup_pictures_come_with_their_stems(tmp_path):
    write_image(tmp_path / "pose_yaw+30.png", 30)
    write_image(tmp_path / "pose_yaw-30.jpg", 90)
    pictures, stems = setup_pictures(tmp_path)
    assert set(stems) == {"pose_yaw+30", "pose_yaw-30"}
    assert pictures[stems.index("pose_yaw+30")][0, 0, 0] == 30


def test_a_picture_of_another_size_is_scaled_and_cut_not_stretched():
    wide = np.zeros((100, 400, 3), np.uint8)
    wide[:, 180:220] = 255
    fitted = fit_to(wide, (100, 50))
    assert fitted.shape == (50, 100, 3)
    # The white bar is 40 wide at half the size: 20, still in the middle.
    white = np.flatnonzero(fitted[25, :, 0] > 127)
    assert (white[0], white[-1]) == (40, 59)


def test_frames_keep_the_size_of_the_first(tmp_path):
    write_image(tmp_path / "a.png")
    write_image(tmp_path / "b.png", size=(100, 90))
    assert [frame.rgb.shape for frame in frames_of(FolderSource(tmp_path))] == [(48, 64, 3)] * 2


def test_absent_camera_lists_those_found():
    with pytest.raises(NoCameraError, match=r"number 3 \(cameras found: camera:0 Laptop camera\)"):
        WebcamSource(3, cameras=ONE_CAMERA)
    with pytest.raises(NoCameraError, match="cameras found: none"):
        WebcamSource(0, cameras=())


def test_camera_in_use_is_given_back_and_says_so():
    device = FakeDevice([], opened=False)
    with pytest.raises(CameraBusyError, match=r"Laptop camera.*another program"):
        WebcamSource(0, cameras=ONE_CAMERA, open_device=lambda *_: device)
    assert device.released


def test_camera_that_may_not_be_read_says_how_to_get_leave():
    cameras = (CameraEntry(0, "Cam", "/dev/there-is-no-such-device"),)
    with pytest.raises(CameraBusyError, match="usermod -aG video"):
        WebcamSource(0, cameras=cameras, open_device=lambda *_: FakeDevice([], opened=False))


def test_camera_frames_keep_the_first_size_and_a_lost_camera_is_reported():
    pictures = [np.zeros((48, 64, 3), np.uint8)] * 2 + [np.zeros((96, 128, 3), np.uint8)]
    device = FakeDevice(pictures)
    with WebcamSource(0, cameras=ONE_CAMERA, open_device=lambda *_: device) as camera:
        assert [camera.read().rgb.shape for _ in range(2)] == [(48, 64, 3)] * 2
        with pytest.raises(CameraLostError, match="after 2 frames"):
            camera.read()
    assert device.released


@pytest.mark.parametrize(
    "text, number", [("camera", 0), ("camera:2", 2), ("1", 1), ("clip.mp4", None), ("cam", None)]
)
def test_what_text_means_a_camera(text, number):
    assert camera_number(text) == number


def test_a_folder_called_like_a_number_is_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "1").mkdir()
    write_image(tmp_path / "1" / "a.png")
    assert isinstance(open_source("1"), FolderSource)


@pytest.mark.slow
def test_real_clip_is_read_whole(clips):
    source = VideoSource(clips / "person_a_2.mp4")
    assert sum(1 for _ in iter(source.read, None)) == 765 == source.n_frames
