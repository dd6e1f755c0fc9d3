import io

import pytest

from app.commands.progress import TerminalProgress, duration, progress_line
from core.errors import NoFaceError
from core.records import Progress


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Clock:
    """Gives a time that moves on by one step with every look."""

    def __init__(self, step_s):
        self.now_s, self.step_s = 0.0, step_s

    def __call__(self):
        self.now_s += self.step_s
        return self.now_s


def steps(n, label="Training"):
    for done in range(1, n + 1):
        yield Progress(done, n, label)
    return "record"


@pytest.mark.parametrize(
    "seconds, text", [(0.2, "0:00"), (7, "0:07"), (65, "1:05"), (3750, "1:02:30")]
)
def test_duration(seconds, text):
    assert duration(seconds) == text


def test_line_has_label_percentage_and_remaining_time():
    line = progress_line(Progress(25, 100, "Training the regressor"), 0.25, 10.0)
    assert line.split() == ["Training", "the", "regressor", "25", "%", "0:30", "left"]


def test_no_remaining_time_is_guessed_from_the_first_moments():
    assert "left" not in progress_line(Progress(1, 100, "Fitting"), 0.01, 10.0)
    assert "left" not in progress_line(Progress(50, 100, "Fitting"), 0.5, 0.1)


def test_a_slow_start_does_not_spoil_the_estimate():
    clock = Clock(0.0)

    def slow_start():
        clock.now_s += 100
        for done in range(1, 11):
            yield Progress(done, 10, "Tracking")
            clock.now_s += 2

    stream = io.StringIO()
    TerminalProgress(stream, clock).follow(slow_start())
    assert "40 %  0:12 left" in stream.getvalue()


def test_work_of_unknown_length_is_counted():
    assert progress_line(Progress(12, 0, "Tracking"), 0.0, 9.0).split() == ["Tracking", "12"]


def test_the_record_comes_through_and_a_terminal_line_is_cleared_at_the_end():
    stream = Terminal()
    assert TerminalProgress(stream, Clock(1.0)).follow(steps(4)) == "record"
    shown = stream.getvalue().split("\r")
    assert [line.split()[1] for line in shown[1:5]] == ["25", "50", "75", "100"]
    assert shown[-2].isspace() and shown[-1] == ""


def test_a_log_gets_a_line_now_and_then_and_at_every_new_label():
    stream = io.StringIO()
    progress = TerminalProgress(stream, Clock(0.5))
    progress.follow(steps(40))
    progress.follow(steps(2, "Fitting"))
    lines = stream.getvalue().splitlines()
    assert len(lines) == 5
    assert lines[-1].startswith("Fitting")


def test_an_error_leaves_a_clean_line_for_its_message():
    def failing():
        yield Progress(1, 2, "Aligning")
        raise NoFaceError("a.png")

    stream = Terminal()
    with pytest.raises(NoFaceError):
        TerminalProgress(stream, Clock(1.0)).follow(failing())
    assert stream.getvalue().endswith(" \r")
