"""Facts about the sounds of the setup and how they are played."""

import wave

import numpy as np
import pytest

from app.resources import asset
from app.sounds import MOST_RUNNING, Speaker
from assets.build.sounds import NOTES, sound


class Process:
    def __init__(self):
        self.running, self.killed = True, False

    def poll(self):
        return None if self.running else 0

    def kill(self):
        self.killed = True

    def wait(self):
        return 0


class Desk:
    """A speaker on a system of our own."""

    def __init__(self, programs=(), system="linux", fails=False):
        self.beeps, self.lines, self.processes, self.fails = 0, [], [], fails
        self.speaker = Speaker(
            self.beep, system, lambda name: name if name in programs else None, self.start
        )

    def beep(self):
        self.beeps += 1

    def start(self, line):
        if self.fails:
            raise FileNotFoundError(line[0])
        self.lines.append(line)
        self.processes.append(Process())
        return self.processes[-1]


@pytest.mark.parametrize("name", list(NOTES))
def test_the_shipped_sounds_are_those_of_the_script_and_short(name):
    path = asset("sounds") / f"{name}.wav"
    assert path.read_bytes() == sound(NOTES[name])
    with wave.open(str(path)) as file:
        samples = np.frombuffer(file.readframes(file.getnframes()), "<i2")
        assert file.getnframes() / file.getframerate() < 0.8
    assert 2000 < np.abs(samples).max() < 32767
    # No click at either end.
    assert abs(int(samples[0])) < 200 and abs(int(samples[-1])) < 200


def test_the_best_player_that_is_there_plays():
    desk = Desk(("aplay", "paplay"))
    desk.speaker.play("taken")
    assert desk.lines[0][0] == "paplay" and desk.lines[0][-1].endswith("taken.wav")
    mac = Desk(("afplay",), "darwin")
    mac.speaker.play("done")
    assert mac.lines[0][0] == "afplay"


def test_without_a_player_it_beeps():
    desk = Desk()
    desk.speaker.play("taken")
    assert desk.beeps == 1 and desk.lines == []


def test_a_player_that_cannot_be_started_is_not_tried_again():
    desk = Desk(("aplay",), fails=True)
    desk.speaker.play("taken")
    desk.fails = False
    desk.speaker.play("taken")
    assert desk.beeps == 2 and desk.lines == []


def test_a_player_that_hangs_is_not_started_without_end():
    desk = Desk(("aplay",))
    for _ in range(MOST_RUNNING + 3):
        desk.speaker.play("hold")
    assert len(desk.lines) == MOST_RUNNING
    desk.processes[0].running = False
    desk.speaker.play("hold")
    assert len(desk.lines) == MOST_RUNNING + 1
    desk.speaker.close()
    assert all(process.killed for process in desk.processes[1:])


def test_who_wants_no_sound_hears_none():
    desk = Desk(("aplay",))
    desk.speaker.muted = True
    desk.speaker.play("taken")
    assert desk.beeps == 0 and desk.lines == []
