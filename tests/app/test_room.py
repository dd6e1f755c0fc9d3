import pytest

from app.room import check_room
from core.generations import ProfileUnwritableError


def test_a_trial_leaves_nothing_behind(tmp_path):
    check_room(tmp_path / "profiles" / "me")
    assert list(tmp_path.iterdir()) == []


def test_what_was_there_stays(tmp_path):
    (tmp_path / "notes").write_text("mine")
    check_room(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes"]


def test_where_nothing_can_be_written_it_is_said(tmp_path):
    (tmp_path / "me").write_text("no folder")
    with pytest.raises(ProfileUnwritableError, match="cannot write the profile"):
        check_room(tmp_path / "me")


def test_a_full_disk_is_noticed_and_the_trial_goes(tmp_path, monkeypatch):
    def full(path, content):
        path.write_bytes(content[:10])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("app.room.write_through", full)
    with pytest.raises(ProfileUnwritableError, match="no space left"):
        check_room(tmp_path)
    assert list(tmp_path.iterdir()) == []
