"""Makes the sounds of the guided setup: short, soft tones of our own.

    python -m assets.build.sounds

The same bytes each time.
"""

import io
import wave
from pathlib import Path

import numpy as np

from core.records import FloatArray

RATE_HZ = 22050
#: Sound -> its notes: begin in s, frequency in Hz, length in s, loudness.
NOTES: dict[str, tuple[tuple[float, float, float, float], ...]] = {
    # The face is right: hold still.
    "hold": ((0.0, 660.0, 0.10, 0.18),),
    # A picture was taken.
    "taken": ((0.0, 880.0, 0.14, 0.35), (0.07, 1318.5, 0.22, 0.35)),
    # A picture was taken, but it is weak.
    "weak": ((0.0, 440.0, 0.16, 0.35), (0.09, 349.2, 0.26, 0.35)),
    # All pictures are taken.
    "done": ((0.0, 659.3, 0.2, 0.3), (0.11, 830.6, 0.2, 0.3), (0.22, 987.8, 0.45, 0.35)),
    # There is no picture any more.
    "trouble": ((0.0, 330.0, 0.2, 0.35), (0.22, 330.0, 0.25, 0.35)),
}


def tone(frequency_hz: float, length_s: float) -> FloatArray:
    """Return a struck tone: a fundamental with two overtones that fade faster."""
    time_s = np.arange(round(RATE_HZ * length_s)) / RATE_HZ
    parts = [(1, 1.0, 5.0), (2, 0.35, 9.0), (3, 0.12, 14.0)]
    wave_ = sum(
        loud * np.exp(-fade * time_s / length_s) * np.sin(2 * np.pi * n * frequency_hz * time_s)
        for n, loud, fade in parts
    )
    attack = np.minimum(time_s / 0.004, 1.0)
    release = np.minimum((length_s - time_s) / 0.02, 1.0)
    return np.asarray(wave_ * attack * release)


def sound(notes: tuple[tuple[float, float, float, float], ...]) -> bytes:
    """Return the content of a WAV file, 16 bit, one channel."""
    total_s = max(begin + length for begin, _, length, _ in notes)
    mixed = np.zeros(round(RATE_HZ * total_s) + 1)
    for begin, frequency, length, loud in notes:
        one = loud * tone(frequency, length)
        first = round(RATE_HZ * begin)
        mixed[first : first + len(one)] += one[: len(mixed) - first]
    samples = np.round(32767 * np.clip(0.8 * mixed, -1, 1)).astype("<i2")
    buffer = io.BytesIO()
    with wave.open(buffer, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE_HZ)
        file.writeframes(samples.tobytes())
    return buffer.getvalue()


def main() -> None:
    """Write all sounds."""
    folder = Path(__file__).resolve().parent.parent / "sounds"
    folder.mkdir(exist_ok=True)
    for name, notes in NOTES.items():
        content = sound(notes)
        (folder / f"{name}.wav").write_bytes(content)
        print(f"{name}.wav: {len(content)} bytes")


if __name__ == "__main__":
    main()
