import pytest

from app.errors import SourceMissingError
from app.performer.opening import Scenario
from app.sources import SOURCE_HELP, NotPerformedError, open_source, scenario_of


def test_the_performer_is_a_source_by_name():
    with open_source("performer:talking") as source:
        assert source.name == "virtual performer (mara, talking)"
        assert not source.live and source.size_px == (640, 480)
    with open_source("performer", live=True) as source:
        assert source.live


def test_conditions_and_a_person_can_be_asked_for():
    with open_source("performer:talking+glasses+dim@tomas") as source:
        assert source.name == "virtual performer (tomas, talking, glasses, dim)"


@pytest.mark.parametrize(
    ("text", "scenario"),
    [
        ("performer", Scenario()),
        ("performer:", Scenario()),
        ("performer:@ayo", Scenario(person="ayo")),
        ("performer:+beard", Scenario(conditions=("beard",))),
        ("performer:still+hand@ayo", Scenario("still", "ayo", conditions=("hand",))),
    ],
)
def test_every_part_of_the_name_may_be_missing(text, scenario):
    assert scenario_of(text) == scenario


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("performer:juggling", "no take 'juggling', expected one of mixed, talking"),
        ("performer:still+hat", "no condition 'hat', expected one of glasses, beard"),
        ("performer:still+", "no condition '', expected one of glasses"),
        ("performer:still+dim+dim", "no condition 'dim twice'"),
        ("performer:still@zoe", "no person 'zoe', expected one of mara, tomas, ayo"),
        ("performer:still@", "no person ''"),
    ],
)
def test_an_unknown_name_lists_those_there_are(text, message):
    with pytest.raises(NotPerformedError, match=message):
        open_source(text)


def test_the_help_names_everything_that_can_be_asked_for():
    for name in ("head_motion", "glasses", "fringe", "dim", "tomas"):
        assert name in SOURCE_HELP


def test_other_names_are_cameras_or_files(tmp_path):
    with pytest.raises(SourceMissingError):
        open_source(str(tmp_path / "performer"))
