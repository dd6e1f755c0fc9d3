"""Image and previous 3D shape -> 3D shape of this frame [Cao13, algorithm 2]."""

from dataclasses import dataclass

import numpy as np

from core.appearance import AppearanceReader, room_for
from core.fern_regressor import FernRegressor
from core.kernels.stages import FernRoom, Stages, run_stages
from core.kernels.starts import (
    align_rotation,
    center_shape,
    choose_starts,
    combine_runs,
    place_starts,
    squared_distances,
    turn_shape,
    turned_distances,
)
from core.records import U8, Camera, FloatArray, Shape3D
from core.region_check import region_shares
from core.shape_space import distinct, pairwise_rotations

__all__ = ["FernRegressor", "Regression", "RegressionSettings"]

#: Runs are laid out in blocks of so many, the width of a vector instruction.
LANES = 8


@dataclass(frozen=True, slots=True)
class RegressionSettings:
    """How a regressor is applied.

    Attributes:
        n_runs: L, starting shapes [Cao13: 15].
        use_median: Combine the runs by their median, as in the paper, instead of their mean.
        again_mm: Run a second time, from the first result, if that lies further than this (RMS)
            from the previous shape; one pass reaches about 10 degrees or 10 mm.
        keep_size: Slide the result along the lines of sight to where its size is the user's;
            see core.head_size.
        same_pose: Turn all starts like the nearest original shape, as the guesses were in
            training. False: the paper, where heads turned otherwise are starts as they are.
    """

    n_runs: int = 15
    use_median: bool = False
    again_mm: float = 8.0
    keep_size: bool = True
    same_pose: bool = True


def _stages(regressor: FernRegressor) -> Stages:
    """Return the arrays of all stages as the kernels take them."""
    n_stages, n_steps, n_points, _ = regressor.basis_mm.shape
    return Stages(
        regressor.corners,
        regressor.weights,
        regressor.offsets_mm,
        regressor.members,
        regressor.cell,
        regressor.pairs,
        regressor.thresholds,
        regressor.leaves,
        regressor.basis_mm.reshape(n_stages, n_steps, 3 * n_points),
    )


class Regression:
    """Applies a regressor frame by frame.

    All work space is made once. Inside, shapes live in the shape space: turned by M^a and
    around the origin, so that the way back to the camera is one rotation and one shift.
    """

    def __init__(
        self,
        regressor: FernRegressor,
        camera: Camera,
        settings: RegressionSettings | None = None,
    ) -> None:
        """Take a regressor and the camera of the frames to come."""
        self._regressor = regressor
        self._settings = settings or RegressionSettings()
        self._frame_shape = camera.size_px[::-1]
        self._projection = np.array([camera.focal_px, *camera.center_px], np.float32)
        self._stages = _stages(regressor)
        self._softening = float(regressor.softening)
        self._make_room()

    def _make_room(self) -> None:
        """Allocate everything that a frame needs."""
        regressor, n_runs = self._regressor, self._settings.n_runs
        n_shapes, n_points, _ = regressor.shapes_mm.shape
        lanes = -(-n_runs // LANES) * LANES
        self._choose_originals()
        self._steps = n_points * np.sum(regressor.translations_mm**2, axis=1)
        self._check_reader = AppearanceReader(n_points, regressor.check_points(), 1)
        self._shapes = np.empty((lanes, n_points, 3), np.float32)
        self._room = room_for(n_points, regressor.points(0), lanes)
        self._to_camera, self._shift = np.empty((3, 3), np.float32), np.empty(3, np.float32)
        self._center, self._rotation = np.zeros(3), np.eye(3)
        self._centred, self._turned = np.empty((n_points, 3)), np.empty((n_points, 3))
        self._scratch, self._turn = np.empty((3, 4, 4)), np.empty((3, 3))
        self._distances = np.empty(n_shapes)
        self._start_distances = np.empty(len(self._originals))
        self._chosen = np.zeros((n_runs, 2), np.int32)
        self._values = np.empty(n_runs)
        self._ferns = _fern_room(regressor, n_runs, lanes)
        self._result = np.empty((n_points, 3))
        self._difference = np.empty(len(regressor.check_mean), np.float32)
        self._inside = np.empty(len(regressor.check_basis), np.float32)
        self._explained = np.empty_like(self._difference)
        self._region_shares = region_shares(regressor.check_corners, regressor.check_weights)

    def _choose_originals(self) -> None:
        """Keep the originals of starts, and how they are turned for each nearest shape."""
        shapes = self._regressor.shapes_mm
        rotations = pairwise_rotations(shapes)
        # Turned alike, pictures of a head turned further would start from the same shape twice.
        kept = distinct(shapes, rotations) if self._settings.same_pose else np.arange(len(shapes))
        self._originals = np.ascontiguousarray(shapes[kept])
        self._rotations = np.ascontiguousarray(rotations[:, kept])
        if not self._settings.same_pose:
            self._rotations[:] = np.eye(3)

    def run(self, gray: U8, previous_points_mm: FloatArray) -> Shape3D:
        """Return the shape of this frame.

        We differ from [Cao13, algorithm 2] in four points, each a setting: starts are turned like
        the nearest original shape; the mean of the runs is taken, which trembles less than their
        median; the result gets the size of the user's head; and fast motion gets a second pass.

        Args:
            gray: (H, W) of the camera's size.
            previous_points_mm: (Q, 3) shape in the frame before, camera frame.

        Raises:
            ValueError: The picture has another size or type, or the shape is not finite.
        """
        gray, previous = self._checked(gray, previous_points_mm)
        spread = self._pass(gray, previous)
        moved = np.sqrt(np.mean(np.sum((self._result - previous) ** 2, axis=1)))
        if moved > self._settings.again_mm:
            spread = self._pass(gray, self._result)
        return Shape3D(self._result, spread, *self._residuals(gray))

    def run_from(self, gray: U8, starts_mm: FloatArray) -> Shape3D:
        """Return the shape found from given starts, without M^a, for experiments.

        Args:
            gray: (H, W) of the camera's size.
            starts_mm: (L or fewer, Q, 3) camera frame.

        Raises:
            ValueError: The picture has another size or type, or a shape is not finite.
        """
        gray, starts = self._checked(gray, starts_mm)
        n_starts, lanes = len(starts), len(self._shapes)
        if n_starts > self._settings.n_runs:
            raise ValueError(f"{n_starts} starts, but room for {self._settings.n_runs}")
        self._center[:] = starts.mean(axis=(0, 1))
        self._rotation[:] = np.eye(3)
        filled = np.minimum(np.arange(lanes), n_starts - 1)
        self._shapes[:] = starts[filled] - self._center
        spread = self._regress(gray, n_starts)
        return Shape3D(self._result, spread, *self._residuals(gray))

    def _checked(self, gray: U8, points_mm: FloatArray) -> tuple[U8, FloatArray]:
        """Return both in the one layout for which the kernels are compiled."""
        if gray.shape != self._frame_shape or gray.dtype != np.uint8:
            found = f"picture of shape {gray.shape}, {gray.dtype}"
            raise ValueError(f"{found}, expected {self._frame_shape}, uint8")
        points = np.ascontiguousarray(points_mm, dtype=np.float64)
        if not np.isfinite(points).all():
            raise ValueError("the previous shape has a number that is not finite")
        return np.ascontiguousarray(gray), points

    def _pass(self, gray: U8, previous: FloatArray) -> float:
        """Put the shape found from the previous one into `_result`; return the spread."""
        shapes = self._regressor.shapes_mm
        center_shape(previous, self._center, self._centred)
        squared_distances(self._centred, shapes, self._distances)
        nearest = self._distances.argmin()
        align_rotation(self._centred, shapes[nearest], self._scratch, self._rotation)
        rotations, distances = self._rotations[nearest], self._start_distances
        turn_shape(self._centred, self._rotation, self._turned)
        turned_distances(self._turned, self._originals, rotations, distances)
        choose_starts(distances, self._steps, self._chosen, self._values)
        place_starts(
            self._originals, rotations, self._regressor.translations_mm, self._chosen, self._shapes
        )
        return self._regress(gray, self._settings.n_runs)

    def _regress(self, gray: U8, n_runs: int) -> float:
        """Move the starts through all stages and combine them; return their spread in mm."""
        self._to_camera[:] = self._rotation.T
        self._shift[:] = self._center
        run_stages(
            gray,
            self._stages,
            self._softening,
            self._to_camera,
            self._shift,
            self._projection,
            self._room,
            self._ferns,
            self._shapes,
        )
        use_median = self._settings.use_median
        spread = combine_runs(self._shapes, n_runs, use_median, self._values, self._turned)
        np.matmul(self._turned, self._rotation, out=self._result)
        self._result += self._center
        if self._settings.keep_size:
            self._fit_size()
        return float(spread)

    def _fit_size(self) -> None:
        """Scale the result about the camera's centre until it has the user's size."""
        regressor = self._regressor
        center_shape(self._result, self._center, self._centred)
        align_rotation(self._centred, regressor.mean_mm, self._scratch, self._turn)
        turn_shape(self._centred, self._turn, self._turned)
        size = float(np.vdot(self._turned, regressor.size_gauge))
        # A shape gone astray must not be thrown to the end of the world.
        self._result /= min(max(size, 0.93), 1.07)

    def _residuals(self, gray: U8) -> tuple[float, FloatArray]:
        """Return how unlike the training pictures the frame looks at the result; by region (6,)."""
        regressor, reader = self._regressor, self._check_reader
        reader.shapes[0] = self._result
        softening = float(regressor.check_softening)
        seen = reader.read(gray, self._projection, softening)[:, 0]
        np.subtract(seen, regressor.check_mean, out=self._difference)
        np.matmul(regressor.check_basis, self._difference, out=self._inside)
        np.matmul(self._inside, regressor.check_basis, out=self._explained)
        self._difference -= self._explained
        np.square(self._difference, out=self._difference)
        level = float(regressor.check_level)
        by_region = np.sqrt(self._region_shares @ self._difference) / level
        return float(np.sqrt(self._difference.mean()) / level), by_region.astype(np.float64)


def _fern_room(regressor: FernRegressor, n_runs: int, lanes: int) -> FernRoom:
    """Return the work space of the ferns."""
    n_ferns, n_steps = regressor.pairs.shape[1], regressor.basis_mm.shape[1]
    return FernRoom(
        intensities=np.empty((regressor.corners.shape[1], lanes), np.float32),
        leaf=np.empty((n_ferns, lanes), np.int32),
        short=np.empty((n_runs, n_steps), np.int16),
        taken=np.empty((n_runs, n_steps), np.int32),
    )
