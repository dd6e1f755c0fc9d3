"""The command line as a user meets it: what it says, its exit codes, what it leaves alone."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from app.commands import demo, window
from app.main import DEBIAN_LINE, main, missing_library
from core.generations import write_generation
from run import OFFSCREEN_LIBRARIES, WINDOW_LIBRARIES


@pytest.fixture
def source(tmp_path):
    """A folder of pictures without any face."""
    folder = tmp_path / "pictures"
    folder.mkdir()
    noise = np.random.default_rng(0).integers(0, 255, (12, 120, 160, 3), dtype=np.uint8)
    for n, picture in enumerate(noise):
        cv2.imwrite(str(folder / f"{n}.png"), picture)
    return folder


def contents(folder: Path):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def refused(capsys, *arguments):
    """Run a command that must refuse its input; return its message."""
    assert main([str(argument) for argument in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    # The one line that counts comes last, after notes and progress.
    return err.strip().splitlines()[-1]


@pytest.mark.parametrize("command", ["setup", "track", "evaluate"])
def test_a_missing_source_or_profile_is_named(capsys, tmp_path, command):
    missing = tmp_path / "nothing.mp4"
    message = refused(capsys, command, "anna", missing)
    name = "nothing.mp4" if command == "setup" else "facepuppet setup on the command line"
    assert message.startswith("facepuppet: found no") and name in message


def test_setup_of_a_damaged_video_makes_no_profile(capsys, tmp_path, home):
    video = tmp_path / "clip.mp4"
    video.write_bytes(b"\0" * 5000)
    assert "5000 bytes that are no video" in refused(capsys, "setup", "anna", video)
    video.write_bytes(b"")
    assert "empty file" in refused(capsys, "setup", "anna", video)
    assert contents(home) == {}


def test_setup_of_a_folder_without_images(capsys, tmp_path):
    (tmp_path / "empty").mkdir()
    assert "found no images" in refused(capsys, "setup", "anna", tmp_path / "empty")


def test_setup_without_a_face_says_what_is_needed(capsys, source, home):
    message = refused(capsys, "setup", "anna", source)
    assert "no face found in any of the 12 pictures" in message and "80 px" in message
    assert contents(home) == {}


def test_setup_does_not_overwrite_other_files_or_a_newer_profile(capsys, tmp_path, source):
    other = tmp_path / "holiday"
    other.mkdir()
    (other / "beach.jpg").write_bytes(b"sun")
    assert "holds other files" in refused(capsys, "setup", f"{other}/", source)
    newer = tmp_path / "newer"
    write_generation(newer, {}, {})
    header = json.loads((newer / "profile.json").read_text()) | {"schema": 99}
    (newer / "profile.json").write_text(json.dumps(header))
    before = contents(tmp_path)
    for arguments in (("setup", newer, source), ("track", newer, source)):
        message = refused(capsys, *arguments)
        assert "schema version 99" in message and "update facepuppet" in message
    assert contents(tmp_path) == before


def test_setup_into_an_unwritable_place(capsys, tmp_path, source):
    (tmp_path / "file").write_text("in the way")
    message = refused(capsys, "setup", tmp_path / "file" / "anna", source)
    assert "cannot write the profile" in message and "unchanged" in message


def test_modes_that_do_not_go_with_the_rest_are_refused(capsys, source):
    for mode in ("trained", "auto"):
        message = refused(capsys, "track", "--mode", mode, source)
        assert "needs a profile" in message and "--mode free" in message
    for mode in ("trained", "auto"):
        message = refused(capsys, "track", "anna", source, "--mode", mode, "--focal", "500")
        assert "the profile has the focal length" in message
    message = refused(capsys, "evaluate", "anna", source, "--detection", "adaptive")
    assert "does not go with --mode trained" in message


def test_a_bad_profile_name_is_refused(capsys, source):
    assert "is no name for a profile" in refused(capsys, "setup", "a:b", source)


def test_an_absent_camera_is_no_setup_source(capsys):
    assert "found no file or folder camera" in refused(capsys, "setup", "anna", "camera")


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["track", "anna", "clip.mp4", "--out", "track.txt"], "expected a name ending in .npz"),
        (["track"], "required: SOURCE"),
        (["track", "clip.mp4", "--detection", "0"], "every, adaptive, or a number above 0"),
        (["setup", "anna", "clip.mp4", "--focal", "-3"], "above 0"),
        (["setup", "anna", "clip.mp4", "--focal", "wide"], "--focal"),
        (["nonsense"], "invalid choice"),
    ],
)
def test_the_command_line_itself_is_checked(capsys, arguments, said):
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


def test_without_a_display_the_demo_is_played(monkeypatch, capsys):
    played = []
    monkeypatch.setattr(demo, "play", lambda options: played.append(options) or 0)
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert main([]) == 0
    assert played == [demo.DemoOptions()]
    assert "no display found" in capsys.readouterr().err


def test_with_a_display_the_window_opens(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(window, "open_window", lambda arguments: 7)
    assert main([]) == 7


def test_ctrl_c_ends_with_its_own_exit_code(monkeypatch, capsys):
    def interrupted(options):
        raise KeyboardInterrupt

    monkeypatch.setattr(window, "has_display", lambda: False)
    monkeypatch.setattr(demo, "play", interrupted)
    assert main([]) == 130
    assert capsys.readouterr().err.endswith("facepuppet: stopped\n")


def test_a_missing_system_library_is_named_with_the_line_that_installs_it(monkeypatch, capsys):
    def failing(options):
        raise ImportError("libEGL.so.1: cannot open shared object file: No such file")

    monkeypatch.setattr(window, "has_display", lambda: False)
    monkeypatch.setattr(demo, "play", failing)
    assert main([]) == 2
    said = capsys.readouterr().err
    assert "lacks the system library libEGL.so.1" in said and DEBIAN_LINE in said
    assert missing_library(ImportError("No module named 'x'")) is None


def test_program_and_run_script_name_the_same_system_packages():
    packages = {*OFFSCREEN_LIBRARIES.values(), *WINDOW_LIBRARIES.values()}
    assert set(DEBIAN_LINE.removeprefix("sudo apt-get install ").split()) == packages


@pytest.mark.parametrize("command", [["setup"], ["setup", "me"], ["edit", "me"]])
def test_windows_need_a_display(command, monkeypatch, capsys):
    from app.commands import edit, guided

    monkeypatch.setattr(guided, "has_display", lambda: False)
    monkeypatch.setattr(edit, "has_display", lambda: False)
    assert main(command) == 2
    assert "display" in capsys.readouterr().err
