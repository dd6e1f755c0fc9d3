"""Inner loops of the tracker: registration, the mixture prior, the box-constrained solve.

Letters: L points, B coefficients, Z regions of the prior, S components per region, N most
coefficients in a region, H most history values in a region. Padded axes are read only up to the
region's own counts. Nothing here allocates.
"""

from typing import NamedTuple

import numba
import numpy as np

from core.records import F32, I32, FloatArray

#: Sums may be reordered, which lets them be vectorised; infinities keep their meaning.
REORDER = {"reassoc", "contract", "arcp", "nsz"}


class FaceTables(NamedTuple):
    """What is constant for a user; the data term is in units of the expected noise.

    Attributes:
        neutral: (L, 3) mm.
        deltas: (B, L, 3) mm.
        weights: (L,) of the points, mean 1.
        directions: (B, L, 3) deltas without what a small rigid motion can do, times weight and
            inverse noise variance.
        gram: (B, B) of those, the Hessian of the data term.
        sparsity: (B,) slope of the sparsity term.
        jaw_open: Index of jawOpen.
        mouth_close: Index of mouthClose.
    """

    neutral: FloatArray
    deltas: FloatArray
    weights: FloatArray
    directions: FloatArray
    gram: FloatArray
    sparsity: FloatArray
    jaw_open: int
    mouth_close: int


class PriorTables(NamedTuple):
    """A Gaussian mixture per region, conditioned on some of the previous frames.

    Attributes:
        members: (Z, N) coefficients of each region.
        counts: (Z, 3) coefficients, history values, components of each region.
        log_weights: (Z, S) of the joint density, with its normalisation.
        means: (Z, S, N) of the coefficients where the history is at its mean.
        history_means: (Z, S, H).
        maps: (Z, S, N, H) history -> mean of the coefficients.
        precisions: (Z, S, N, N) of the coefficients given the history.
        whiteners: (Z, S, H, H) lower triangles that make the history's covariance the identity.
    """

    members: I32
    counts: I32
    log_weights: FloatArray
    means: F32
    history_means: F32
    maps: F32
    precisions: F32
    whiteners: F32


class Workspace(NamedTuple):
    """Memory that a frame is solved in; contents do not matter between frames."""

    shape: FloatArray  # (L, 3)
    quartic: FloatArray  # (2, 4, 4)
    pull: FloatArray  # (B,)
    hessian: FloatArray  # (B, B)
    gradient: FloatArray  # (B,)
    log_weights: FloatArray  # (Z, S)
    means: FloatArray  # (Z, S, N)
    shares: FloatArray  # (S,)
    difference: FloatArray  # (max(N, H),)
    residual: FloatArray  # (B,)
    pulled: FloatArray  # (N,)
    factor: FloatArray  # (N, N)


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def largest_eigenvector(matrix: FloatArray, vectors: FloatArray, out: FloatArray) -> None:
    """Write the unit eigenvector of the largest eigenvalue; cyclic Jacobi, `matrix` is spoilt."""
    n = matrix.shape[0]
    for i in range(n):
        for j in range(n):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(12):
        off, on = 0.0, 0.0
        for i in range(n):
            on += matrix[i, i] * matrix[i, i]
            for j in range(i):
                off += matrix[i, j] * matrix[i, j]
        if off <= 1e-30 * on:
            break
        for p in range(n - 1):
            for q in range(p + 1, n):
                if matrix[p, q] == 0.0:
                    continue
                theta = 0.5 * (matrix[q, q] - matrix[p, p]) / matrix[p, q]
                t = 1.0 / (abs(theta) + np.sqrt(theta * theta + 1.0))
                t = -t if theta < 0.0 else t
                c = 1.0 / np.sqrt(t * t + 1.0)
                s = t * c
                for k in range(n):
                    a, b = matrix[k, p], matrix[k, q]
                    matrix[k, p], matrix[k, q] = c * a - s * b, s * a + c * b
                for k in range(n):
                    a, b = matrix[p, k], matrix[q, k]
                    matrix[p, k], matrix[q, k] = c * a - s * b, s * a + c * b
                for k in range(n):
                    a, b = vectors[k, p], vectors[k, q]
                    vectors[k, p], vectors[k, q] = c * a - s * b, s * a + c * b
    best = 0
    for i in range(1, n):
        if matrix[i, i] > matrix[best, best]:
            best = i
    for i in range(n):
        out[i] = vectors[i, best]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def register(
    source: FloatArray,  # (L, 3)
    target: FloatArray,  # (L, 3)
    weights: FloatArray,  # (L,)
    quartic: FloatArray,  # (2, 4, 4) work
    pose: FloatArray,  # (4, 3) out: rotation matrix, then translation
) -> None:
    """Write the rotation and translation that bring `source` nearest to `target`.

    Horn's quaternion form of the registration: the same minimum as by the singular value
    decomposition of the cross-covariance, and never a reflection.
    """
    total = 0.0
    sx, sy, sz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(source.shape[0]):
        w = weights[k]
        total += w
        sx += w * source[k, 0]
        sy += w * source[k, 1]
        sz += w * source[k, 2]
        tx += w * target[k, 0]
        ty += w * target[k, 1]
        tz += w * target[k, 2]
    sx, sy, sz, tx, ty, tz = sx / total, sy / total, sz / total, tx / total, ty / total, tz / total
    xx, xy, xz, yx, yy, yz, zx, zy, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(source.shape[0]):
        w = weights[k]
        ax, ay, az = w * (source[k, 0] - sx), w * (source[k, 1] - sy), w * (source[k, 2] - sz)
        bx, by, bz = target[k, 0] - tx, target[k, 1] - ty, target[k, 2] - tz
        xx += ax * bx
        xy += ax * by
        xz += ax * bz
        yx += ay * bx
        yy += ay * by
        yz += ay * bz
        zx += az * bx
        zy += az * by
        zz += az * bz
    m = quartic[0]
    m[0, 0], m[1, 1], m[2, 2], m[3, 3] = xx + yy + zz, xx - yy - zz, yy - xx - zz, zz - xx - yy
    m[0, 1] = m[1, 0] = yz - zy
    m[0, 2] = m[2, 0] = zx - xz
    m[0, 3] = m[3, 0] = xy - yx
    m[1, 2] = m[2, 1] = xy + yx
    m[1, 3] = m[3, 1] = zx + xz
    m[2, 3] = m[3, 2] = yz + zy
    # The matrix is spoilt by then, so its first row can take the quaternion.
    largest_eigenvector(m, quartic[1], quartic[0, 0])
    w, x, y, z = quartic[0, 0, 0], quartic[0, 0, 1], quartic[0, 0, 2], quartic[0, 0, 3]
    pose[0, 0], pose[0, 1], pose[0, 2] = (
        1 - 2 * (y * y + z * z),
        2 * (x * y - w * z),
        2 * (x * z + w * y),
    )
    pose[1, 0], pose[1, 1], pose[1, 2] = (
        2 * (x * y + w * z),
        1 - 2 * (x * x + z * z),
        2 * (y * z - w * x),
    )
    pose[2, 0], pose[2, 1], pose[2, 2] = (
        2 * (x * z - w * y),
        2 * (y * z + w * x),
        1 - 2 * (x * x + y * y),
    )
    pose[3, 0] = tx - pose[0, 0] * sx - pose[0, 1] * sy - pose[0, 2] * sz
    pose[3, 1] = ty - pose[1, 0] * sx - pose[1, 1] * sy - pose[1, 2] * sz
    pose[3, 2] = tz - pose[2, 0] * sx - pose[2, 1] * sy - pose[2, 2] * sz


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def express(
    neutral: FloatArray,  # (L, 3)
    deltas: FloatArray,  # (B, L, 3)
    coefficients: FloatArray,  # (B,)
    out: FloatArray,  # (L, 3)
) -> None:
    """Write the shape of an expression in the head frame."""
    for k in range(neutral.shape[0]):
        for d in range(3):
            out[k, d] = neutral[k, d]
    for b in range(deltas.shape[0]):
        a = coefficients[b]
        if a != 0.0:
            for k in range(neutral.shape[0]):
                for d in range(3):
                    out[k, d] += a * deltas[b, k, d]


@numba.njit(cache=True, nogil=True)
def sample_history(
    times: FloatArray,  # (M,) rising
    values: FloatArray,  # (M, B)
    count: int,  # of the M that are filled, at least 2
    newest: float,  # time of the first row of the result
    step: float,  # time between rows of the result, into the past
    out: FloatArray,  # (lags, B)
) -> None:
    """Write the values at regular times, interpolated, held beyond both ends."""
    after = count - 1
    for lag in range(out.shape[0]):
        wanted = newest - lag * step
        while after > 1 and times[after - 1] >= wanted:
            after -= 1
        span = times[after] - times[after - 1]
        phase = min(max((wanted - times[after - 1]) / span, 0.0), 1.0)
        for b in range(out.shape[1]):
            before = values[after - 1, b]
            out[lag, b] = before + phase * (values[after, b] - before)


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def condition(
    prior: PriorTables,
    history: FloatArray,  # (lags, B) the previous frames that the tables are conditioned on
    log_weights: FloatArray,  # (Z, S) out
    means: FloatArray,  # (Z, S, N) out
    difference: FloatArray,  # (H,) work
) -> None:
    """Write each component's weight and mean for the coefficients, given the history."""
    for z in range(prior.counts.shape[0]):
        n, n_history, n_components = prior.counts[z, 0], prior.counts[z, 1], prior.counts[z, 2]
        for s in range(n_components):
            for i in range(n_history):
                seen = history[i // n, prior.members[z, i % n]]
                difference[i] = seen - prior.history_means[z, s, i]
            distance = 0.0
            for i in range(n_history):
                white = 0.0
                for j in range(i + 1):
                    white += prior.whiteners[z, s, i, j] * difference[j]
                distance += white * white
            log_weights[z, s] = prior.log_weights[z, s] - 0.5 * distance
            for i in range(n):
                mean = float(prior.means[z, s, i])
                for j in range(n_history):
                    mean += prior.maps[z, s, i, j] * difference[j]
                means[z, s, i] = mean


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def log_evidence(
    prior: PriorTables,
    z: int,
    s: int,
    coefficients: FloatArray,  # (B,)
    weight: float,
    face_gram: FloatArray,  # (B, B)
    amount: float,
    work: Workspace,
) -> float:
    """Return the log probability of the data under one component, other regions held.

    The region's coefficients x are integrated out of data times component: with A the sum of
    both Hessians, that is log weight - log|A|/2 - (least sum of both energies).
    """
    n = prior.counts[z, 0]
    factor, free = work.factor, work.difference
    distance = 0.0
    for i in range(n):
        free[i] = work.means[z, s, i] - coefficients[prior.members[z, i]]
    for i in range(n):
        pulled = 0.0
        for j in range(n):
            entry = weight * prior.precisions[z, s, i, j]
            pulled += entry * free[j]
            factor[i, j] = entry + amount * face_gram[prior.members[z, i], prior.members[z, j]]
        work.pulled[i] = pulled + work.residual[prior.members[z, i]]
        distance += free[i] * pulled
    # Eight pivots of at most some 1e8 each stay far from overflow.
    determinant, gain = 1.0, 0.0
    for i in range(n):
        white = work.pulled[i]
        for j in range(i):
            entry = factor[i, j]
            for k in range(j):
                entry -= factor[i, k] * factor[j, k]
            # The diagonal holds reciprocals: divisions are slow.
            factor[i, j] = entry * factor[j, j]
            white -= factor[i, j] * work.pulled[j]
        pivot = factor[i, i]
        for k in range(i):
            pivot -= factor[i, k] * factor[i, k]
        determinant *= pivot
        factor[i, i] = 1.0 / np.sqrt(pivot)
        work.pulled[i] = white * factor[i, i]
        gain += work.pulled[i] * work.pulled[i]
    return weight * work.log_weights[z, s] - 0.5 * (distance - gain + np.log(determinant))


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def add_prior(
    face: FaceTables,
    prior: PriorTables,
    coefficients: FloatArray,  # (B,)
    amounts: FloatArray,  # (2,) weight of the data, weight of the prior
    work: Workspace,
) -> None:
    """Add the components of every region, as far as responsible, to the quadratic to minimise.

    Responsibilities at the current coefficients would touch -log p from above, but coefficients
    that start at rest then never leave the component of rest. With the evidence of the data for
    each component, the coefficients integrated out, they do as soon as the data say so.
    """
    n_coefficients = coefficients.shape[0]
    for i in range(n_coefficients):
        total = work.gradient[i]
        for j in range(n_coefficients):
            total -= work.hessian[i, j] * coefficients[j]
        # A pull across the bound is no evidence for anything.
        outward = (coefficients[i] <= 0.0 and total < 0.0) or (
            coefficients[i] >= 1.0 and total > 0.0
        )
        work.residual[i] = 0.0 if outward else total
    for z in range(prior.counts.shape[0]):
        n, n_components = prior.counts[z, 0], prior.counts[z, 2]
        highest = -np.inf
        for s in range(n_components):
            work.shares[s] = log_evidence(
                prior, z, s, coefficients, amounts[1], face.gram, amounts[0], work
            )
            highest = max(highest, work.shares[s])
        total = 0.0
        for s in range(n_components):
            work.shares[s] = np.exp(work.shares[s] - highest)
            total += work.shares[s]
        for s in range(n_components):
            share = amounts[1] * work.shares[s] / total
            if share < 1e-5 * amounts[1]:
                continue
            for i in range(n):
                row = prior.members[z, i]
                for j in range(n):
                    entry = share * prior.precisions[z, s, i, j]
                    work.hessian[row, prior.members[z, j]] += entry
                    work.gradient[row] += entry * work.means[z, s, j]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def minimise_in_box(
    hessian: FloatArray,  # (B, B)
    gradient: FloatArray,  # (B,) of the minimised form x'Hx/2 - g'x; spoilt
    first: int,
    second: int,
    out: FloatArray,  # (B,) start in, minimiser out
) -> None:
    """Find the minimiser in [0, 1] with out[first] + out[second] <= 1, by coordinate descent."""
    n = out.shape[0]
    for i in range(n):
        x = out[i]
        if x != 0.0:
            for j in range(n):
                gradient[j] -= hessian[i, j] * x
    for _ in range(100):
        largest = 0.0
        for i in range(n):
            high = 1.0
            if i == first:
                high = 1.0 - out[second]
            elif i == second:
                high = 1.0 - out[first]
            x = min(max(out[i] + gradient[i] / hessian[i, i], 0.0), high)
            step = x - out[i]
            if step != 0.0:
                out[i] = x
                largest = max(largest, abs(step))
                for j in range(n):
                    gradient[j] -= hessian[i, j] * step
        if largest < 1e-5:
            break


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def solve_expression(face: FaceTables, work: Workspace, coefficients: FloatArray) -> None:
    """Minimise the assembled quadratic over the coefficients, mouthClose at most jawOpen.

    The lips can be closed only as far as the jaw is open. With jawOpen = opening + mouthClose
    that bound is opening >= 0: a box again, in which coordinate descent cannot get stuck.
    """
    jaw, close, n = face.jaw_open, face.mouth_close, coefficients.shape[0]
    work.gradient[close] += work.gradient[jaw]
    for j in range(n):
        work.hessian[close, j] += work.hessian[jaw, j]
    for j in range(n):
        work.hessian[j, close] += work.hessian[j, jaw]
    coefficients[jaw] = max(coefficients[jaw] - coefficients[close], 0.0)
    minimise_in_box(work.hessian, work.gradient, jaw, close, coefficients)
    coefficients[jaw] += coefficients[close]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def pull_of_data(
    face: FaceTables,
    points: FloatArray,  # (L, 3) camera frame
    pose: FloatArray,  # (4, 3)
    work: Workspace,
) -> None:
    """Write to `work.pull` the data term's slope at the neutral face."""
    for k in range(points.shape[0]):
        x, y, z = points[k, 0] - pose[3, 0], points[k, 1] - pose[3, 1], points[k, 2] - pose[3, 2]
        for d in range(3):
            turned = pose[0, d] * x + pose[1, d] * y + pose[2, d] * z
            work.shape[k, d] = turned - face.neutral[k, d]
    for b in range(face.deltas.shape[0]):
        total = 0.0
        for k in range(points.shape[0]):
            for d in range(3):
                total += face.directions[b, k, d] * work.shape[k, d]
        work.pull[b] = total - face.sparsity[b]


@numba.njit(cache=True, nogil=True, fastmath=REORDER)
def track(
    face: FaceTables,
    prior: PriorTables,
    points: FloatArray,  # (L, 3) camera frame
    history: FloatArray,  # (lags, B)
    amounts: FloatArray,  # (2,) weight of the data, weight of the prior
    iterations: int,
    work: Workspace,
    coefficients: FloatArray,  # (B,) start in, result out
    pose: FloatArray,  # (4, 3) out: rotation matrix, then translation
) -> float:
    """Solve one frame [Cao13, face tracking, eq. 11-14]: pose and coefficients in turn.

    Returns the weighted RMS distance per coordinate that is left.
    """
    n = coefficients.shape[0]
    condition(prior, history, work.log_weights, work.means, work.difference)
    for _ in range(iterations):
        express(face.neutral, face.deltas, coefficients, work.shape)
        register(work.shape, points, face.weights, work.quartic, pose)
        pull_of_data(face, points, pose, work)
        for i in range(n):
            work.gradient[i] = amounts[0] * work.pull[i]
            for j in range(n):
                work.hessian[i, j] = amounts[0] * face.gram[i, j]
        add_prior(face, prior, coefficients, amounts, work)
        solve_expression(face, work, coefficients)
    express(face.neutral, face.deltas, coefficients, work.shape)
    register(work.shape, points, face.weights, work.quartic, pose)
    total = 0.0
    for k in range(points.shape[0]):
        for d in range(3):
            mapped = pose[3, d] - points[k, d]
            for e in range(3):
                mapped += pose[d, e] * work.shape[k, e]
            total += face.weights[k] * mapped * mapped
    return np.sqrt(total / (3.0 * points.shape[0]))
