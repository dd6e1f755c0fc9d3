"""Inner loops of the training-free tracker: reprojection, its derivatives, both solvers.

Letters: L landmarks that are fitted (internal ones, then 15 of the outline), B coefficients,
W points of all contour strips, N = 6 + B unknowns: rotation, translation, coefficients. The last
axis is the landmark, so that loops over it are vectorised. Nothing here allocates.
"""

from typing import NamedTuple

import numba
import numpy as np

from core.records import I32, FloatArray

#: Sums may be reordered, which lets them be vectorised; infinities keep their meaning.
REORDER = {"reassoc", "contract", "arcp", "nsz"}
N_POSE = 6
#: Nothing is nearer to the camera than this, mm.
_NEAREST_MM = 20.0
#: A strip seen exactly from the side counts as near, as in core.contour.
_EDGE_ON = 1e-6
#: The outline is chosen anew in so many of the first joint steps; later it could go to and fro.
_PICKS = 3


class FaceTables(NamedTuple):
    """One face as the solvers look at it; the columns of the outline change with the pose.

    Attributes:
        neutral: (3, L) mm, model frame; the last 15 columns are the picked contour points.
        deltas: (B, 3, L) mm, alike.
        strip_neutral: (3, W) mm of all strips' points.
        strip_deltas: (B, 3, W) mm.
        strip_starts: (16,) where each strip begins among the W.
        fixed: (15,) strip points that are the outline of a frontal face.
        outward: (15, 3) the way out of the face on each strip.
        picks: (15,) the strip points that are the outline now; -1: none yet.
    """

    neutral: FloatArray
    deltas: FloatArray
    strip_neutral: FloatArray
    strip_deltas: FloatArray
    strip_starts: I32
    fixed: I32
    outward: FloatArray
    picks: I32


class Workspace(NamedTuple):
    """Memory that a frame is solved in; contents do not matter between frames."""

    shape: FloatArray  # (3, L) model frame
    strips: FloatArray  # (3, W) model frame
    lift: FloatArray  # (3, 2, L) d(u, v)/d(model point)
    root: FloatArray  # (L,) roots of the landmarks' weights
    residual: FloatArray  # (2, L) times root
    jacobian: FloatArray  # (N, 2, L) times root
    hessian: FloatArray  # (N, N)
    gradient: FloatArray  # (N,)
    factor: FloatArray  # (N, N)
    step: FloatArray  # (N,)
    trial: FloatArray  # (B,)
    pose: FloatArray  # (4, 3)


@numba.njit(cache=True, nogil=True)
def matrix_of(vector: FloatArray, out: FloatArray) -> None:
    """Write the rotation matrix (3, 3) of a rotation vector (3,)."""
    x, y, z = vector[0], vector[1], vector[2]
    square = x * x + y * y + z * z
    if square < 1e-14:
        a, b = 1.0 - square / 6.0, 0.5 - square / 24.0
    else:
        angle = np.sqrt(square)
        a, b = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
    out[0, 0], out[0, 1], out[0, 2] = 1 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y
    out[1, 0], out[1, 1], out[1, 2] = b * x * y + a * z, 1 - b * (x * x + z * z), b * y * z - a * x
    out[2, 0], out[2, 1], out[2, 2] = b * x * z - a * y, b * y * z + a * x, 1 - b * (x * x + y * y)


@numba.njit(cache=True, nogil=True)
def left_jacobian(vector: FloatArray, out: FloatArray) -> None:
    """Write J (3, 3): exp(r + dr) is exp(J dr) exp(r) for small dr."""
    x, y, z = vector[0], vector[1], vector[2]
    square = x * x + y * y + z * z
    if square < 1e-10:
        a, b = 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    else:
        angle = np.sqrt(square)
        a, b = (1.0 - np.cos(angle)) / square, (angle - np.sin(angle)) / (square * angle)
    out[0, 0], out[0, 1], out[0, 2] = 1 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y
    out[1, 0], out[1, 1], out[1, 2] = b * x * y + a * z, 1 - b * (x * x + z * z), b * y * z - a * x
    out[2, 0], out[2, 1], out[2, 2] = b * x * z - a * y, b * y * z + a * x, 1 - b * (x * x + y * y)


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def express(
    neutral: FloatArray,  # (3, P)
    deltas: FloatArray,  # (B, 3, P)
    coefficients: FloatArray,  # (B,)
    out: FloatArray,  # (3, P)
) -> None:
    """Write the shape of an expression in the model frame [FaceIt19, eq. 3]."""
    for d in range(3):
        for k in range(neutral.shape[1]):
            out[d, k] = neutral[d, k]
    for b in range(deltas.shape[0]):
        a = coefficients[b]
        if a != 0.0:
            for d in range(3):
                for k in range(neutral.shape[1]):
                    out[d, k] += a * deltas[b, d, k]


@numba.njit(cache=True, nogil=True)
def _take_strip_point(face: FaceTables, strip: int, place: int) -> None:
    """Make a strip's point the landmark of that strip."""
    column = face.neutral.shape[1] - face.fixed.shape[0] + strip
    face.picks[strip] = place
    for d in range(3):
        face.neutral[d, column] = face.strip_neutral[d, place]
        for b in range(face.deltas.shape[0]):
            face.deltas[b, d, column] = face.strip_deltas[b, d, place]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def pick_outline(
    face: FaceTables,
    pose: FloatArray,  # (4, 3) rotation matrix, then translation
    coefficients: FloatArray,  # (B,)
    work: Workspace,
) -> None:
    """Choose the contour points for a pose and expression, as core.contour does."""
    express(face.neutral, face.deltas, coefficients, work.shape)
    express(face.strip_neutral, face.strip_deltas, coefficients, work.strips)
    n_strips = face.fixed.shape[0]
    n_internal = face.neutral.shape[1] - n_strips
    sx, sy, sz = 0.0, 0.0, 0.0
    for k in range(n_internal):
        sx, sy, sz = sx + work.shape[0, k], sy + work.shape[1, k], sz + work.shape[2, k]
    sx, sy, sz = sx / n_internal, sy / n_internal, sz / n_internal
    mx = pose[0, 0] * sx + pose[0, 1] * sy + pose[0, 2] * sz + pose[3, 0]
    my = pose[1, 0] * sx + pose[1, 1] * sy + pose[1, 2] * sz + pose[3, 1]
    mz = pose[2, 0] * sx + pose[2, 1] * sy + pose[2, 2] * sz + pose[3, 2]
    length = np.sqrt(mx * mx + my * my + mz * mz)
    for s in range(n_strips):
        ox, oy, oz = face.outward[s, 0], face.outward[s, 1], face.outward[s, 2]
        ax = pose[0, 0] * ox + pose[0, 1] * oy + pose[0, 2] * oz
        ay = pose[1, 0] * ox + pose[1, 1] * oy + pose[1, 2] * oz
        az = pose[2, 0] * ox + pose[2, 1] * oy + pose[2, 2] * oz
        place = face.fixed[s]
        if (ax * mx + ay * my + az * mz) / length >= _EDGE_ON:
            furthest = -np.inf
            for k in range(face.strip_starts[s], face.strip_starts[s + 1]):
                px, py, pz = work.strips[0, k], work.strips[1, k], work.strips[2, k]
                x = pose[0, 0] * px + pose[0, 1] * py + pose[0, 2] * pz + pose[3, 0]
                y = pose[1, 0] * px + pose[1, 1] * py + pose[1, 2] * pz + pose[3, 1]
                z = pose[2, 0] * px + pose[2, 1] * py + pose[2, 2] * pz + pose[3, 2]
                along = (ax * x + ay * y) / max(z, _NEAREST_MM)
                if along > furthest:
                    furthest, place = along, k
        if place != face.picks[s]:
            _take_strip_point(face, s, place)


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def reproject(
    points: FloatArray,  # (2, L) px
    camera: FloatArray,  # (3,) focal length and principal point, px
    pose: FloatArray,  # (4, 3)
    work: Workspace,
) -> float:
    """Write the weighted residuals of `work.shape`; return the sum of their squares."""
    shape, total = work.shape, 0.0
    for k in range(points.shape[1]):
        px, py, pz = shape[0, k], shape[1, k], shape[2, k]
        x = pose[0, 0] * px + pose[0, 1] * py + pose[0, 2] * pz + pose[3, 0]
        y = pose[1, 0] * px + pose[1, 1] * py + pose[1, 2] * pz + pose[3, 1]
        z = pose[2, 0] * px + pose[2, 1] * py + pose[2, 2] * pz + pose[3, 2]
        scale = camera[0] / max(z, _NEAREST_MM)
        u = work.root[k] * (scale * x + camera[1] - points[0, k])
        v = work.root[k] * (scale * y + camera[2] - points[1, k])
        work.residual[0, k], work.residual[1, k] = u, v
        total += u * u + v * v
    return total


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def pose_jacobian(
    camera: FloatArray,  # (3,)
    pose: FloatArray,  # (4, 3)
    work: Workspace,
) -> None:
    """Write d(u, v)/d(turn from the left, translation) and, to `work.lift`, d/d(model point)."""
    shape, lift, out = work.shape, work.lift, work.jacobian
    for k in range(shape.shape[1]):
        px, py, pz = shape[0, k], shape[1, k], shape[2, k]
        qx = pose[0, 0] * px + pose[0, 1] * py + pose[0, 2] * pz
        qy = pose[1, 0] * px + pose[1, 1] * py + pose[1, 2] * pz
        qz = pose[2, 0] * px + pose[2, 1] * py + pose[2, 2] * pz
        inverse = 1.0 / max(qz + pose[3, 2], _NEAREST_MM)
        x, y = (qx + pose[3, 0]) * inverse, (qy + pose[3, 1]) * inverse
        scale = work.root[k] * camera[0] * inverse
        out[0, 0, k], out[0, 1, k] = -scale * x * qy, -scale * (qz + y * qy)
        out[1, 0, k], out[1, 1, k] = scale * (qz + x * qx), scale * y * qx
        out[2, 0, k], out[2, 1, k] = -scale * qy, scale * qx
        out[3, 0, k], out[3, 1, k] = scale, 0.0
        out[4, 0, k], out[4, 1, k] = 0.0, scale
        out[5, 0, k], out[5, 1, k] = -scale * x, -scale * y
        for d in range(3):
            lift[d, 0, k] = scale * (pose[0, d] - x * pose[2, d])
            lift[d, 1, k] = scale * (pose[1, d] - y * pose[2, d])


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def expression_jacobian(face: FaceTables, work: Workspace) -> None:
    """Write d(u, v)/d(coefficients), from `work.lift`."""
    for b in range(face.deltas.shape[0]):
        delta = face.deltas[b]
        for c in range(2):
            out = work.jacobian[N_POSE + b, c]
            for k in range(out.shape[0]):
                out[k] = (
                    work.lift[0, c, k] * delta[0, k]
                    + work.lift[1, c, k] * delta[1, k]
                    + work.lift[2, c, k] * delta[2, k]
                )


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def normal_equations(work: Workspace, first: int, last: int) -> None:
    """Write J'J and J'r of the unknowns first..last-1.

    Two rows times four at once share what they read: five times as fast as one by one, and
    faster than leaving out the zeros.
    """
    jacobian = work.jacobian.reshape(work.jacobian.shape[0], work.residual.size)
    residual, hessian = work.residual.reshape(work.residual.size), work.hessian
    for i in range(first, last, 2):
        # Past the end the last row is repeated.
        n = min(i + 1, last - 1)
        a, b = jacobian[i], jacobian[n]
        a4, b4 = 0.0, 0.0
        for k in range(residual.shape[0]):
            a4 += a[k] * residual[k]
            b4 += b[k] * residual[k]
        work.gradient[i], work.gradient[n] = a4, b4
        for j in range(first, n + 1, 4):
            j1, j2, j3 = min(j + 1, n), min(j + 2, n), min(j + 3, n)
            r0, r1, r2, r3 = jacobian[j], jacobian[j1], jacobian[j2], jacobian[j3]
            a0, a1, a2, a3, b0, b1, b2, b3 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(residual.shape[0]):
                x, y = a[k], b[k]
                a0 += x * r0[k]
                a1 += x * r1[k]
                a2 += x * r2[k]
                a3 += x * r3[k]
                b0 += y * r0[k]
                b1 += y * r1[k]
                b2 += y * r2[k]
                b3 += y * r3[k]
            hessian[i, j], hessian[i, j1], hessian[i, j2], hessian[i, j3] = a0, a1, a2, a3
            hessian[n, j], hessian[n, j1], hessian[n, j2], hessian[n, j3] = b0, b1, b2, b3
    for i in range(first, last):
        for j in range(first, i):
            hessian[j, i] = hessian[i, j]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def solve_damped(
    hessian: FloatArray,  # (M, M)
    gradient: FloatArray,  # (M,)
    damping: float,
    factor: FloatArray,  # (M, M) work
    step: FloatArray,  # (M,) out
) -> None:
    """Solve (H + damping diag H) step = -g by Cholesky's factors.

    An unknown whose row is zero stays where it is.
    """
    n = step.shape[0]
    for i in range(n):
        row = factor[i]
        for j in range(i):
            other, entry = factor[j], hessian[i, j]
            for k in range(j):
                entry -= row[k] * other[k]
            # The diagonal holds reciprocals: divisions are slow.
            row[j] = entry * other[j]
        pivot, white = hessian[i, i] * (1.0 + damping), -gradient[i]
        for k in range(i):
            pivot -= row[k] * row[k]
            white -= row[k] * step[k]
        row[i] = 1.0 / np.sqrt(pivot) if pivot > 1e-12 * hessian[i, i] else 0.0
        step[i] = white * row[i]
    for i in range(n - 1, -1, -1):
        row = factor[i]
        step[i] *= row[i]
        for k in range(i):
            step[k] -= row[k] * step[i]


# The paper's solver: pose and expression in turn, each by Levenberg-Marquardt.

#: What keeps coefficients in range: eq. 12 as it is given, or plain bounds.
BARRIER, BOX = 0, 1
_LEAST_DAMPING, _MOST_DAMPING = 1e-9, 1e9
#: |w| is smoothed below this.
_L1_WIDTH = 1e-3


class PaperTerms(NamedTuple):
    """The weights of [FaceIt19, eq. 5-12]; energies are in px^2 at the usual size of a face.

    Attributes:
        smooth: (6,) of the squared second differences of rotation vector and translation.
        sparsity: Of the sum of the coefficients' magnitudes.
        barrier: (4,) weight and a, b, c of eq. 12.
        bounds: BARRIER or BOX.
    """

    smooth: FloatArray
    sparsity: float
    barrier: FloatArray
    bounds: int


@numba.njit(cache=True, nogil=True)
def unpack_pose(vector: FloatArray, out: FloatArray) -> None:
    """Write the pose (4, 3) of a rotation vector and translation in a row (6,)."""
    matrix_of(vector[:3], out)
    for d in range(3):
        out[3, d] = vector[3 + d]


@numba.njit(cache=True, nogil=True)
def pose_energy(
    vector: FloatArray,  # (6,)
    predicted: FloatArray,  # (6,)
    terms: PaperTerms,
    points: FloatArray,
    camera: FloatArray,
    work: Workspace,
) -> float:
    """Return [FaceIt19, eq. 8 and 9] at a pose; writes residuals and `work.pose`."""
    unpack_pose(vector, work.pose)
    total = reproject(points, camera, work.pose, work)
    for i in range(N_POSE):
        total += terms.smooth[i] * (vector[i] - predicted[i]) ** 2
    return total


@numba.njit(cache=True, nogil=True)
def pose_equations(
    vector: FloatArray,  # (6,)
    predicted: FloatArray,  # (6,)
    terms: PaperTerms,
    camera: FloatArray,
    work: Workspace,
) -> None:
    """Write half the gradient and the Gauss-Newton Hessian of `pose_energy`.

    The residuals must be those of this pose.
    """
    hessian, gradient, turn = work.hessian, work.gradient, work.factor
    pose_jacobian(camera, work.pose, work)
    # From a turn applied from the left to a change of the rotation vector.
    left_jacobian(vector[:3], turn)
    for c in range(2):
        for k in range(work.shape.shape[1]):
            x, y, z = work.jacobian[0, c, k], work.jacobian[1, c, k], work.jacobian[2, c, k]
            for d in range(3):
                work.jacobian[d, c, k] = x * turn[0, d] + y * turn[1, d] + z * turn[2, d]
    normal_equations(work, 0, N_POSE)
    for i in range(N_POSE):
        hessian[i, i] += terms.smooth[i]
        gradient[i] += terms.smooth[i] * (vector[i] - predicted[i])


@numba.njit(cache=True, nogil=True)
def fit_pose(
    face: FaceTables,
    points: FloatArray,  # (2, L)
    camera: FloatArray,  # (3,)
    terms: PaperTerms,
    predicted: FloatArray,  # (6,) where the head would be without acceleration
    coefficients: FloatArray,  # (B,)
    iterations: int,
    work: Workspace,
    vector: FloatArray,  # (6,) start in, result out
) -> float:
    """Minimise [FaceIt19, eq. 8 and 9] by Levenberg-Marquardt; return the energy."""
    express(face.neutral, face.deltas, coefficients, work.shape)
    trial = work.trial[:N_POSE]
    energy = pose_energy(vector, predicted, terms, points, camera, work)
    damping, fresh = 1e-4, False
    for _ in range(iterations):
        if not fresh:
            pose_equations(vector, predicted, terms, camera, work)
            fresh = True
        solve_damped(
            work.hessian[:N_POSE, :N_POSE], work.gradient[:N_POSE], damping,
            work.factor[:N_POSE, :N_POSE], work.step[:N_POSE],
        )  # fmt: skip
        for i in range(N_POSE):
            trial[i] = vector[i] + work.step[i]
        reached = pose_energy(trial, predicted, terms, points, camera, work)
        if reached <= energy:
            vector[:], energy, fresh = trial, reached, False
            damping = max(0.1 * damping, _LEAST_DAMPING)
        else:
            damping = min(10.0 * damping, _MOST_DAMPING)
    return energy


@numba.njit(cache=True, nogil=True)
def barrier_value(weight: float, barrier: FloatArray) -> float:
    """Return [FaceIt19, eq. 12] of one coefficient."""
    a, b, c = barrier[1], barrier[2], barrier[3]
    return np.pi / 4 * (np.arctan((weight - a) / b) - np.arctan((weight + a - 1.0) / b)) + c


@numba.njit(cache=True, nogil=True)
def expression_energy(
    coefficients: FloatArray,  # (B,)
    face: FaceTables,
    terms: PaperTerms,
    points: FloatArray,
    camera: FloatArray,
    work: Workspace,
) -> float:
    """Return [FaceIt19, eq. 10-12], with the pose; writes residuals and `work.shape`."""
    express(face.neutral, face.deltas, coefficients, work.shape)
    total = reproject(points, camera, work.pose, work)
    for b in range(coefficients.shape[0]):
        w = coefficients[b]
        total += terms.sparsity * np.sqrt(w * w + _L1_WIDTH * _L1_WIDTH)
        if terms.bounds == BARRIER:
            total += terms.barrier[0] * barrier_value(w, terms.barrier)
    return total


@numba.njit(cache=True, nogil=True)
def expression_equations(
    coefficients: FloatArray,  # (B,)
    face: FaceTables,
    terms: PaperTerms,
    camera: FloatArray,
    work: Workspace,
) -> None:
    """Write half the gradient of `expression_energy`, and a positive Hessian.

    The residuals must be those of these coefficients. The l1 term's curvature is that of the
    parabola which touches it from above; the barrier's is left out where it is negative.
    """
    pose_jacobian(camera, work.pose, work)
    expression_jacobian(face, work)
    normal_equations(work, N_POSE, work.hessian.shape[0])
    weight, a, b = terms.barrier[0], terms.barrier[1], terms.barrier[2]
    for k in range(coefficients.shape[0]):
        w, i = coefficients[k], N_POSE + k
        magnitude = np.sqrt(w * w + _L1_WIDTH * _L1_WIDTH)
        work.gradient[i] += 0.5 * terms.sparsity * w / magnitude
        work.hessian[i, i] += 0.5 * terms.sparsity / magnitude
        if terms.bounds == BARRIER:
            above, below = (w - a) / b, (w + a - 1.0) / b
            rise, fall = 1.0 / (1.0 + above * above), 1.0 / (1.0 + below * below)
            work.gradient[i] += 0.5 * weight * np.pi / 4 * (rise - fall) / b
            bend = 2.0 * (below * fall * fall - above * rise * rise) / (b * b)
            work.hessian[i, i] += max(0.5 * weight * np.pi / 4 * bend, 0.0)
        elif (w <= 0.0 and work.gradient[i] > 0.0) or (w >= 1.0 and work.gradient[i] < 0.0):
            _hold(work, i)


@numba.njit(cache=True, nogil=True)
def _hold(work: Workspace, index: int) -> None:
    """Take one unknown out of the equations."""
    for j in range(work.hessian.shape[0]):
        work.hessian[index, j] = work.hessian[j, index] = 0.0
    work.gradient[index] = 0.0


@numba.njit(cache=True, nogil=True)
def fit_expression(
    face: FaceTables,
    points: FloatArray,  # (2, L)
    camera: FloatArray,  # (3,)
    terms: PaperTerms,
    pose: FloatArray,  # (4, 3)
    iterations: int,
    work: Workspace,
    coefficients: FloatArray,  # (B,) start in, result out
) -> int:
    """Minimise [FaceIt19, eq. 10-12] by Levenberg-Marquardt; return how many steps were taken."""
    n, taken = coefficients.shape[0], 0
    work.pose[:] = pose
    energy = expression_energy(coefficients, face, terms, points, camera, work)
    damping, fresh = 1e-4, False
    for _ in range(iterations):
        if not fresh:
            expression_equations(coefficients, face, terms, camera, work)
            fresh = True
        solve_damped(
            work.hessian[N_POSE:, N_POSE:], work.gradient[N_POSE:], damping,
            work.factor[N_POSE:, N_POSE:], work.step[N_POSE:],
        )  # fmt: skip
        for b in range(n):
            work.trial[b] = coefficients[b] + work.step[N_POSE + b]
            if terms.bounds == BOX:
                work.trial[b] = min(max(work.trial[b], 0.0), 1.0)
        reached = expression_energy(work.trial, face, terms, points, camera, work)
        if reached <= energy:
            coefficients[:], energy, fresh = work.trial, reached, False
            damping = max(0.1 * damping, _LEAST_DAMPING)
            taken += 1
        else:
            damping = min(10.0 * damping, _MOST_DAMPING)
    return taken


# The joint solver: pose and expression move together, by Gauss-Newton with bounds.


class JointTerms(NamedTuple):
    """What the joint solver knows besides the landmarks, in units of their noise.

    Attributes:
        robust: Distance in units of noise at which a landmark counts a quarter.
        slope: (B,) cost of using a coefficient at all.
        precision: (B,) inverse variances around zero.
        memory: (B,) inverse variances of the change from the last frame.
        escape: Change of a coefficient at which the memory counts a quarter.
        jaw_open: Index of jawOpen.
        mouth_close: Index of mouthClose, which cannot exceed it.
    """

    robust: float
    slope: FloatArray
    precision: FloatArray
    memory: FloatArray
    escape: float
    jaw_open: int
    mouth_close: int


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def weigh(
    points: FloatArray,  # (2, L)
    camera: FloatArray,  # (3,)
    pose: FloatArray,  # (4, 3)
    weights: FloatArray,  # (L,) inverse variances, 1/px^2
    robust: float,
    widen: float,
    work: Workspace,
) -> float:
    """Write the roots of the weights that distances of `work.shape` deserve [Geman, McClure].

    Returns the robust energy, sum of s^2 r^2 / (s^2 + r^2). Far from the solution every distance
    is large: `widen` times their root mean square is the least s.
    """
    for k in range(points.shape[1]):
        work.root[k] = np.sqrt(weights[k])
    mean = reproject(points, camera, pose, work) / points.shape[1]
    total, limit = 0.0, max(robust * robust, widen * widen * mean)
    for k in range(points.shape[1]):
        square = work.residual[0, k] ** 2 + work.residual[1, k] ** 2
        share = limit / (limit + square)
        total += share * square
        work.root[k] *= share
        work.residual[0, k] *= share
        work.residual[1, k] *= share
    return total


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def add_knowledge(
    terms: JointTerms,
    last: FloatArray,  # (B,) of the last frame
    coefficients: FloatArray,  # (B,)
    work: Workspace,
) -> None:
    """Add sparsity, range and memory of the coefficients to the equations."""
    for b in range(coefficients.shape[0]):
        i, w = N_POSE + b, coefficients[b]
        change = w - last[b]
        # A quick movement is no noise: beyond `escape` the past loses its hold.
        held = 1.0 / (1.0 + (change / terms.escape) ** 2)
        hold = terms.memory[b] * held * held
        work.hessian[i, i] += terms.precision[b] + hold
        work.gradient[i] += terms.precision[b] * w + terms.slope[b] + hold * change


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def _eliminate_pose(work: Workspace) -> None:
    """Reduce the equations to the coefficients: the Schur complement of the pose.

    Row by row Gaussian elimination; the pose's rows stay for `_follow`.
    """
    n, hessian, gradient = work.hessian.shape[0], work.hessian, work.gradient
    for p in range(N_POSE):
        inverse = 1.0 / hessian[p, p]
        for i in range(p + 1, n):
            ratio = hessian[i, p] * inverse
            if ratio != 0.0:
                for j in range(p + 1, n):
                    hessian[i, j] -= ratio * hessian[p, j]
                gradient[i] -= ratio * gradient[p]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def _follow(work: Workspace) -> None:
    """Write the pose's step that belongs to the coefficients' step."""
    n = work.hessian.shape[0]
    for p in range(N_POSE - 1, -1, -1):
        total = -work.gradient[p]
        for j in range(p + 1, n):
            total -= work.hessian[p, j] * work.step[j]
        work.step[p] = total / work.hessian[p, p]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def _step_in_box(terms: JointTerms, sweeps: int, coefficients: FloatArray, work: Workspace) -> None:
    """Write the coefficients' step: the minimum of the reduced quadratic in the box.

    Coordinate descent over the values. With jawOpen = opening + mouthClose, the bound
    mouthClose <= jawOpen is opening >= 0: again a box, in which it cannot get stuck.
    """
    n, jaw, close = coefficients.shape[0], N_POSE + terms.jaw_open, N_POSE + terms.mouth_close
    hessian, gradient, step = work.hessian, work.gradient, work.step
    gradient[close] += gradient[jaw]
    for j in range(N_POSE, N_POSE + n):
        hessian[close, j] += hessian[jaw, j]
    for j in range(N_POSE, N_POSE + n):
        hessian[j, close] += hessian[j, jaw]
    value = work.trial
    value[:] = coefficients
    value[terms.jaw_open] = max(value[terms.jaw_open] - value[terms.mouth_close], 0.0)
    for _ in range(sweeps):
        largest = 0.0
        for b in range(n):
            i, high = N_POSE + b, 1.0
            if b == terms.jaw_open:
                high = 1.0 - value[terms.mouth_close]
            elif b == terms.mouth_close:
                high = 1.0 - value[terms.jaw_open]
            new = min(max(value[b] - gradient[i] / hessian[i, i], 0.0), high)
            move = new - value[b]
            if move != 0.0:
                value[b] = new
                largest = max(largest, abs(move))
                for j in range(N_POSE, N_POSE + n):
                    gradient[j] += hessian[i, j] * move
        if largest < 1e-4:
            break
    value[terms.jaw_open] += value[terms.mouth_close]
    for b in range(n):
        step[N_POSE + b] = value[b] - coefficients[b]


@numba.njit(cache=True, nogil=True)
def _move_pose(step: FloatArray, longest_turn: float, turn: FloatArray, pose: FloatArray) -> None:
    """Turn a pose from the left, shift it, and keep its rows orthonormal."""
    size = np.sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2])
    share = 1.0 if size <= longest_turn else longest_turn / size
    for d in range(3):
        # The last rows of the work matrix are not used by the rotation.
        turn[3, d] = share * step[d]
        pose[3, d] += share * step[3 + d] if d < 2 else 0.0
    # The inverse of the depth is what a picture shows: a long step overshoots.
    depth = pose[3, 2]
    pose[3, 2] = min(max(depth + share * step[5], 0.6 * depth), 1.7 * depth)
    matrix_of(turn[3, :3], turn)
    for j in range(3):
        x, y, z = pose[0, j], pose[1, j], pose[2, j]
        for i in range(3):
            pose[i, j] = turn[i, 0] * x + turn[i, 1] * y + turn[i, 2] * z
    for i in range(2):
        for k in range(i):
            along = 0.0
            for j in range(3):
                along += pose[i, j] * pose[k, j]
            for j in range(3):
                pose[i, j] -= along * pose[k, j]
        length = np.sqrt(pose[i, 0] ** 2 + pose[i, 1] ** 2 + pose[i, 2] ** 2)
        for j in range(3):
            pose[i, j] /= length
    pose[2, 0] = pose[0, 1] * pose[1, 2] - pose[0, 2] * pose[1, 1]
    pose[2, 1] = pose[0, 2] * pose[1, 0] - pose[0, 0] * pose[1, 2]
    pose[2, 2] = pose[0, 0] * pose[1, 1] - pose[0, 1] * pose[1, 0]


@numba.njit(cache=True, nogil=True)
def fit_jointly(
    face: FaceTables,
    points: FloatArray,  # (2, L)
    camera: FloatArray,  # (3,)
    weights: FloatArray,  # (L,) inverse variances, 1/px^2
    terms: JointTerms,
    last: FloatArray,  # (B,) coefficients of the last frame
    iterations: int,
    work: Workspace,
    pose: FloatArray,  # (4, 3) start in, result out
    coefficients: FloatArray,  # (B,) start in, result out
) -> float:
    """Minimise all terms over pose and coefficients; return the robust energy of the data."""
    widen = 4.0
    for n in range(iterations):
        if n < _PICKS:
            pick_outline(face, pose, coefficients, work)
        express(face.neutral, face.deltas, coefficients, work.shape)
        weigh(points, camera, pose, weights, terms.robust, widen, work)
        widen *= 0.25
        pose_jacobian(camera, pose, work)
        expression_jacobian(face, work)
        normal_equations(work, 0, work.hessian.shape[0])
        add_knowledge(terms, last, coefficients, work)
        _eliminate_pose(work)
        _step_in_box(terms, 30, coefficients, work)
        _follow(work)
        _move_pose(work.step, 0.3, work.factor, pose)
        coefficients[:] = work.trial
        largest = 0.0
        for i in range(work.step.shape[0]):
            # A pixel is about a mm: the mm of a shift count like hundredths of a coefficient.
            unit = 0.01 if 3 <= i < N_POSE else 1.0
            largest = max(largest, unit * abs(work.step[i]))
        if largest < 2e-4:
            break
    express(face.neutral, face.deltas, coefficients, work.shape)
    return weigh(points, camera, pose, weights, terms.robust, 0.0, work)
