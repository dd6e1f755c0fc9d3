"""The synthetic webcam behind the lens: exposure, focus, noise, sharpening, compression."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from core.records import F32, U8

_N_NOISE_FIELDS = 4


def steady(time_s: float) -> float:
    """Return the gain of an exposure that stays the same."""
    return 1.0


@dataclass(frozen=True, slots=True)
class SensorSettings:
    """What kind of webcam it is; the defaults are a decent one in a room at day.

    Attributes:
        exposure_s: Time that the shutter is open.
        softness_px: Standard deviation of the lens blur, mean.
        focus_breath_px: How much the blur comes and goes while the autofocus searches.
        sharpening: Share of detail that the webcam adds again.
        read_noise: Standard deviation in black, grey levels.
        shot_noise: Standard deviation in white beyond it, grey levels.
        flicker: Relative size of the changes of exposure.
        jpeg_quality: Of the compression on the wire, 1 to 100.
        gain: Of the exposure at a time in s, on the encoded grey levels.
    """

    exposure_s: float = 1 / 60
    softness_px: float = 0.55
    focus_breath_px: float = 0.25
    sharpening: float = 0.35
    read_noise: float = 1.0
    shot_noise: float = 2.2
    flicker: float = 0.02
    jpeg_quality: int = 88
    gain: Callable[[float], float] = steady


class Sensor:
    """Turns clean pictures into webcam pictures, the same ones for the same seed.

    It remembers nothing from picture to picture but fields of noise drawn once: one is laid on
    each picture shifted and mirrored, which costs a tenth of drawing new noise.
    """

    def __init__(self, size_px: tuple[int, int], settings: SensorSettings, seed: int) -> None:
        self.settings = settings
        self._seed = seed
        rng = np.random.default_rng([seed, 7])
        width, height = size_px
        self._fields = [_noise_field(height, width, rng) for _ in range(_N_NOISE_FIELDS)]
        self._phases = rng.uniform(0, 2 * np.pi, 4)

    def develop(self, clean: U8, time_s: float, index: int) -> U8:
        """Return the picture (H, W, 3) that the webcam makes of a clean one.

        Args:
            clean: (H, W, 3) RGB.
            time_s: Drives flicker and focus.
            index: Of the frame; chooses its noise.
        """
        s = self.settings
        breath = s.focus_breath_px * np.sin(2.2 * time_s + self._phases[0])
        sigma = max(0.3, s.softness_px + breath * np.sin(0.37 * time_s + self._phases[1]))
        soft = cv2.GaussianBlur(clean, (0, 0), sigma)
        if s.sharpening > 0:
            blurred = cv2.GaussianBlur(soft, (0, 0), 1.2)
            soft = cv2.addWeighted(soft, 1 + s.sharpening, blurred, -s.sharpening, 0)
        exposed = cv2.LUT(soft, self._exposure_table(time_s))
        noisy = self._add_noise(exposed, index)
        return _through_jpeg(noisy, s.jpeg_quality)

    def _exposure_table(self, time_s: float) -> U8:
        """Return (256,) the grey levels after this frame's exposure."""
        # Lamps on 50 Hz mains beat slowly with a 30 Hz camera; auto-exposure hunts slower.
        beat = 0.4 * np.sin(2 * np.pi * 1.3 * time_s + self._phases[2])
        hunt = 0.6 * np.sin(2 * np.pi * 0.17 * time_s + self._phases[3])
        gain = self.settings.gain(time_s) * (1 + self.settings.flicker * (beat + hunt))
        return np.asarray(np.clip(np.arange(256) * gain + 0.5, 0, 255).astype(np.uint8))

    def _add_noise(self, picture: U8, index: int) -> U8:
        """Return the picture with read noise and shot noise."""
        s = self.settings
        rng = np.random.default_rng([self._seed, 11, index])
        height, width = picture.shape[:2]
        field = self._fields[rng.integers(_N_NOISE_FIELDS)]
        top, left = rng.integers(0, 64, 2)
        noise = field[top : top + height, left : left + width]
        flip = int(rng.integers(-1, 3))
        noise = noise if flip == 2 else cv2.flip(noise, flip)
        deviation = np.sqrt(s.read_noise**2 + s.shot_noise**2 * np.arange(256) / 255)
        grain = cv2.LUT(picture, deviation.astype(np.float32))
        shaken = cv2.multiply(grain, noise)
        return np.asarray(cv2.add(picture, shaken, dtype=cv2.CV_8U))


def _noise_field(height: int, width: int, rng: np.random.Generator) -> F32:
    """Return (H + 64, W + 64, 3) unit noise, a bit alike in neighbours as after demosaicing."""
    white = rng.standard_normal((height + 64, width + 64, 3), dtype=np.float32)
    common = rng.standard_normal((height + 64, width + 64, 1), dtype=np.float32)
    grain = cv2.GaussianBlur(white * 0.7 + common * 0.7, (0, 0), 0.55)
    return np.asarray(grain / grain.std(), np.float32)


def _through_jpeg(picture: U8, quality: int) -> U8:
    """Return the picture after compression and decompression, as from an MJPG camera."""
    # The coder takes what it gets for BGR: the planes must be in that order for its chroma.
    bgr = np.ascontiguousarray(picture[..., ::-1])
    coded = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    decoded = np.asarray(cv2.imdecode(coded, cv2.IMREAD_COLOR), np.uint8)
    return np.ascontiguousarray(decoded[..., ::-1])
