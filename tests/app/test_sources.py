import pytest

from app.errors import SourceMissingError
from app.sources import NoTakeError, open_source


def test_the_performer_is_a_source_by_name():
    with open_source("performer:talking") as source:
        assert source.name == "virtual performer (mara, talking)"
        assert not source.live and source.size_px == (640, 480)
    with open_source("performer", live=True) as source:
        assert source.live


def test_an_unknown_take_lists_those_there_are():
    with pytest.raises(NoTakeError, match="no take 'juggling', expected one of mixed, talking"):
        open_source("performer:juggling")


def test_other_names_are_cameras_or_files(tmp_path):
    with pytest.raises(SourceMissingError):
        open_source(str(tmp_path / "performer"))
