import threading

import moderngl
import numpy as np
import pytest

from app.render.avatar import Part, part_of, sparse_deltas
from app.render.context import RenderError, make_context
from app.render.eyeball import EDGE_RAD, eyeball, gaze_matrix
from app.render.programs import source
from app.render.renderer import Item, Scene
from app.render.scene import Lights, Material, Mesh, View, placed, studio_lights
from app.render.thinning import bends, simplified, thinned
from app.render.thread import RenderThread
from core.camera import camera_for, project
from core.kernels.antialias import gray_of, lay_over, mark_edges, smooth_edges
from core.kernels.morph import add_sparse_deltas, interleave, vertex_normals
from tests.app.gl import renderer_or_skip

CAMERA = camera_for((96, 72), 110.0)
WHITE = np.full((2, 2, 3), 255, np.uint8)
#: Light from all sides and no lamp: a white surface looks the same wherever it is.
EVEN = Lights(np.eye(3), np.zeros((3, 3)), np.ones(3), np.ones(3))


@pytest.fixture(scope="module")
def renderer():
    renderer = renderer_or_skip()
    yield renderer
    renderer.release()


def square(half_mm=10.0):
    """A square that faces the viewer, who is at -z."""
    corners = half_mm * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    normals, extra = np.tile([0, 0, -1], (4, 1)), np.tile([0, 1, 1, 1], (4, 1))
    return Mesh(corners, normals, corners[:, :2] / 20 + 0.5, extra, [[0, 2, 1], [0, 3, 2]])


def at(*translation_mm, rotation=None):
    return placed(np.eye(3) if rotation is None else rotation, np.array(translation_mm, float))


def picture_of(renderer, places, material=None, **scene):
    drawable = renderer.upload(square(), material or Material("plain", WHITE))
    items = [Item(drawable, place, place) for place in places]
    scene = {"view": View(CAMERA), "lights": EVEN, "backdrop": None} | scene
    return renderer.draw(Scene(scene["view"], scene["lights"], items, scene["backdrop"]))


def center_px(mask):
    rows, columns = np.nonzero(mask)
    return np.array([columns.mean(), rows.mean()])


@pytest.mark.gl
@pytest.mark.parametrize("place", [(0, 0, 250), (30, -12, 250), (-50, 30, 400), (45, 35, 300)])
def test_a_point_is_drawn_where_the_camera_projects_it(renderer, place):
    picture = picture_of(renderer, [at(*place)], view=View(CAMERA, supersampling=2))
    share = picture[..., 3] / 255.0
    ys, xs = np.mgrid[0:72, 0:96]
    seen = np.array([(share * xs).sum(), (share * ys).sum()]) / share.sum()
    np.testing.assert_allclose(seen, project(CAMERA, np.array(place, float)), atol=0.1)


@pytest.mark.gl
def test_depth_is_the_distance_along_the_axis_of_view(renderer):
    drawable = renderer.upload(square(), Material("plain", WHITE))
    place = at(20, 10, 330)
    depth = renderer.depth_mm(Scene(View(CAMERA), EVEN, [Item(drawable, place, place)]))
    column, row = np.round(project(CAMERA, place[:3, 3])).astype(int)
    assert abs(depth[row, column] - 330) < 0.5
    assert np.isinf(depth[0, 0])


@pytest.mark.gl
def test_the_back_of_a_surface_is_drawn_only_if_it_has_two_sides(renderer):
    turned = at(0, 0, 250, rotation=gaze_matrix(np.pi, 0))
    assert picture_of(renderer, [turned])[..., 3].max() == 0
    two_sided = Material("plain", WHITE, two_sided=True)
    assert picture_of(renderer, [turned], two_sided)[..., 3].max() == 255


@pytest.mark.gl
def test_the_nearer_surface_hides_the_further_whatever_comes_first(renderer):
    near = renderer.upload(square(), Material("plain", WHITE))
    far = renderer.upload(square(30), Material("plain", WHITE // 4))
    items = [Item(near, at(0, 0, 200), np.eye(4)), Item(far, at(0, 0, 300), np.eye(4))]
    first = renderer.draw(Scene(View(CAMERA), EVEN, items))
    second = renderer.draw(Scene(View(CAMERA), EVEN, items[::-1]))
    np.testing.assert_array_equal(first, second)
    assert first[36, 48, 0] > first[36, 56, 0] > 0


@pytest.mark.gl
def test_the_texture_is_upright(renderer):
    texture = np.zeros((2, 2, 3), np.uint8)
    texture[0, 0] = 255  # first row, first column: upper left
    picture = picture_of(renderer, [at(0, 0, 120)], Material("plain", texture)).astype(int)
    assert picture[30, 42, 0] > 150 > picture[42, 42, 0]
    assert picture[30, 54, 0] < 150


@pytest.mark.gl
def test_vertices_held_by_the_body_stay_with_it(renderer):
    mesh = square()
    held = Mesh(mesh.vertices_mm, mesh.normals, mesh.uv, mesh.extra + [1, 0, 0, 0], mesh.triangles)
    drawable = renderer.upload(held, Material("plain", WHITE))
    item = Item(drawable, at(60, 0, 250), at(0, 0, 250))
    picture = renderer.draw(Scene(View(CAMERA), EVEN, [item]))
    np.testing.assert_allclose(center_px(picture[..., 3] > 127), CAMERA.center_px, atol=0.3)


@pytest.mark.gl
def test_blended_surfaces_mix_with_what_is_behind_them(renderer):
    glass = np.full((2, 2, 4), 255, np.uint8)
    glass[..., 3] = 128
    values = {"cutoff": 0.0, "shine": 0.0}
    lash = renderer.upload(square(), Material("hair", glass * [0, 0, 0, 1], values, blended=True))
    wall = renderer.upload(square(40), Material("plain", WHITE))
    items = [Item(lash, at(0, 0, 200), np.eye(4)), Item(wall, at(0, 0, 300), np.eye(4))]
    picture = renderer.draw(Scene(View(CAMERA), EVEN, items)).astype(int)
    assert abs(picture[36, 48, 0] - picture[36, 62, 0] / 2) < 4
    assert picture[36, 48, 3] == 255


@pytest.mark.gl
def test_the_backdrop_shows_where_nothing_is(renderer):
    backdrop = np.zeros((72, 96, 3), np.uint8)
    backdrop[:, :48] = (10, 200, 30)
    picture = picture_of(renderer, [at(0, 0, 250)], backdrop=backdrop)
    assert tuple(picture[3, 3]) == (10, 200, 30, 255)
    assert tuple(picture[3, 90]) == (0, 0, 0, 255)
    assert picture[36, 48, 2] > 150
    small = picture_of(renderer, [at(0, 0, 250)], backdrop=backdrop[::2, ::2])
    assert np.abs(small.astype(int) - picture).max() <= 1


@pytest.mark.gl
def test_light_comes_from_the_side_of_the_lamp(renderer):
    def brightness(direction):
        lamp = Lights(
            np.tile(direction, (3, 1)), np.eye(3)[[0]] * np.ones((3, 3)) / 3, *np.zeros((2, 3))
        )
        picture = picture_of(renderer, [at(0, 0, 250)], lights=lamp)
        return int(picture[36, 48, 0])

    assert brightness([0, 0, -1]) > brightness([1, 0, -1]) > brightness([1, 0, -0.1])
    assert brightness([0, 0, 1]) == 0


@pytest.mark.gl
def test_moved_vertices_move_in_the_next_picture(renderer):
    drawable = renderer.upload(square(), Material("plain", WHITE))
    scene = Scene(View(CAMERA), EVEN, [Item(drawable, at(0, 0, 250), np.eye(4))])
    before = center_px(renderer.draw(scene)[..., 3] > 127)
    mesh = square()
    rows = np.concatenate([mesh.vertices_mm + [25, 0, 0], mesh.normals], axis=1)
    drawable.move(np.ascontiguousarray(rows, np.float32))
    after = center_px(renderer.draw(scene)[..., 3] > 127)
    np.testing.assert_allclose(after - before, [25 * 110 / 250, 0], atol=0.3)


def test_a_machine_without_opengl_says_what_to_install(monkeypatch):
    def nothing(**_):
        raise Exception("requested OpenGL 330, got nothing")

    monkeypatch.setattr(moderngl, "create_context", nothing)
    with pytest.raises(RenderError, match=r"got nothing.*install the driver") as caught:
        make_context()
    assert caught.value.found == "requested OpenGL 330, got nothing"


@pytest.mark.parametrize("material", ["skin", "eye", "hair", "wet", "plain"])
def test_shaders_are_whole_after_their_includes(material):
    text = source(f"{material}.frag")
    assert text.startswith("#version 330")
    assert "#include" not in text
    assert text.count("void main()") == 1


@pytest.mark.gl
def test_the_thread_draws_the_newest_wish_and_forgets_the_older_ones():
    renderer_or_skip().release()
    started, release, drawn = threading.Event(), threading.Event(), []

    def make(_renderer):
        def draw(wish):
            started.set()
            release.wait(5)
            return wish

        return draw

    thread = RenderThread(make, drawn.append, drawn.append)
    thread.start()
    thread.ask(1)
    assert started.wait(10)
    for wish in (2, 3, 4):
        thread.ask(wish)
    release.set()
    while len(drawn) < 2:
        release.wait(0.01)
        threading.Event().wait(0.01)
    thread.stop()
    assert drawn == [1, 4]
    assert not thread.is_alive()


def test_the_thread_reports_that_it_cannot_draw(monkeypatch):
    def nothing(**_):
        raise Exception("no EGL")

    monkeypatch.setattr(moderngl, "create_context", nothing)
    failures = []
    thread = RenderThread(lambda _renderer: lambda wish: wish, failures.append, failures.append)
    thread.start()
    thread.join(10)
    assert [type(error) for error in failures] == [RenderError]


def test_sparse_deltas_add_up_to_the_dense_ones(rng):
    deltas = rng.normal(0, 1, (5, 40, 3)).astype(np.float32)
    deltas[:, 10:30] = 0
    weights = np.array([0.3, 0, 1, 0.5, 0], np.float32)
    neutral = rng.normal(0, 50, (40, 3)).astype(np.float32)
    starts, rows, entries = sparse_deltas(deltas)
    out = neutral.copy()
    add_sparse_deltas(weights, starts, rows, entries, out)
    expected = neutral + np.tensordot(weights, deltas, axes=1)
    np.testing.assert_allclose(out, expected, atol=1e-4)
    assert len(rows) == 5 * 20


def test_normals_of_a_sphere_point_away_from_its_middle():
    directions, _, triangles = eyeball()
    normals = np.empty_like(directions)
    vertex_normals(directions, triangles, normals)
    inner = directions[:, 2] < np.cos(np.pi - EDGE_RAD + 0.25)
    assert (np.sum(normals * directions, axis=1)[inner] > 0.995).all()


def test_a_vertex_in_no_triangle_faces_the_viewer():
    normals = np.empty((4, 3), np.float32)
    points = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [5, 5, 5]], np.float32)
    vertex_normals(points, np.array([[0, 1, 2]], np.int32), normals)
    np.testing.assert_allclose(normals, np.tile([0, 0, -1], (4, 1)), atol=1e-6)


def test_the_buffer_repeats_vertices_at_seams():
    points = np.arange(9, dtype=np.float32).reshape(3, 3)
    out = np.empty((4, 6), np.float32)
    interleave(points, -points, np.array([2, 0, 2, 1], np.int32), out)
    np.testing.assert_array_equal(out, np.concatenate([points, -points], axis=1)[[2, 0, 2, 1]])


def test_a_part_has_one_vertex_per_place_and_texture_coordinate():
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    uv = np.array([[[0, 0], [1, 0], [1, 1]], [[0.5, 0], [1, 1], [0, 1]]], np.float32)
    extra = np.zeros((4, 4), np.float32)
    part = part_of(Material("plain", WHITE), triangles, uv, extra)
    assert len(part.rows) == 5  # vertex 0 has two coordinates
    np.testing.assert_array_equal(part.rows[part.triangles], triangles)
    np.testing.assert_allclose(part.uv[part.triangles], uv, atol=1e-4)


def test_eyes_turn_to_the_side_and_up_that_the_gaze_names():
    straight = np.array([0, 0, -1.0])
    left, up = gaze_matrix(0.3, 0) @ straight, gaze_matrix(0, 0.3) @ straight
    np.testing.assert_allclose(left, [np.sin(0.3), 0, -np.cos(0.3)])
    np.testing.assert_allclose(up, [0, -np.sin(0.3), -np.cos(0.3)])


def test_the_eye_texture_is_a_front_view():
    directions, uv, _ = eyeball()
    angle = np.arccos(np.clip(-directions[:, 2], -1, 1))
    np.testing.assert_allclose(np.hypot(*(uv - 0.5).T) * 2 * EDGE_RAD, angle, atol=1e-4)


def slanted_edge():
    """A dark half plane with a nearly level edge, sharp and as it should be."""
    ys, xs = np.mgrid[0:40, 0:60]
    height = 20.3 + xs / 7.0
    truth = np.clip(height - ys + 0.5, 0, 1)
    both = [np.repeat((255 * a)[..., None], 4, axis=2) for a in (truth > 0.5, truth)]
    return [np.ascontiguousarray(a.round().astype(np.uint8)) for a in both]


def smoothed(picture):
    gray, out = np.empty(picture.shape[:2], np.uint8), picture.copy()
    marks = np.empty_like(gray)
    gray_of(picture, gray)
    mark_edges(gray, marks)
    smooth_edges(picture, gray, marks, out)
    return out


def test_a_slanted_edge_comes_nearer_to_its_true_coverage():
    sharp, truth = slanted_edge()
    error = [np.abs(a.astype(int) - truth).mean() for a in (sharp, smoothed(sharp))]
    assert error[1] < 0.35 * error[0]


def test_a_straight_edge_and_a_flat_area_stay_as_they_are():
    picture = np.zeros((30, 30, 4), np.uint8)
    picture[:, 15:] = 255
    np.testing.assert_array_equal(smoothed(picture), picture)


def test_a_backdrop_shines_through_as_much_as_alpha_lets_it(rng):
    backdrop = rng.integers(0, 256, (6, 5, 3)).astype(np.uint8)
    alpha = np.array([0, 255, 100], np.uint8)[rng.integers(0, 3, (6, 5))]
    picture = np.zeros((6, 5, 4), np.uint8)
    picture[..., :3] = (rng.random((6, 5, 3)) * alpha[..., None]).astype(np.uint8)
    picture[..., 3] = alpha
    expected = picture[..., :3] + np.round(backdrop * (1 - alpha[..., None] / 255))
    lay_over(backdrop, picture)
    np.testing.assert_allclose(picture[..., :3], np.minimum(expected, 255), atol=1)
    assert (picture[..., 3] == 255).all()


def test_studio_lights_lie_before_the_subject_but_for_the_rim():
    key, fill, rim = studio_lights().directions
    assert key[2] < 0
    assert fill[2] < 0
    assert rim[2] > 0


# -- thinning --------------------------------------------------------------------------


def dome(steps=24):
    """Half a ball of 50 mm with a flat rim, as a grid: points, triangles."""
    x, y = np.meshgrid(*2 * [np.linspace(-60, 60, steps)])
    z = -np.sqrt(np.maximum(50.0**2 - x**2 - y**2, 0))
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()]).astype(np.float32)
    first = (np.arange(steps - 1)[:, None] * steps + np.arange(steps - 1)).ravel()
    quads = np.column_stack([first, first + 1, first + steps + 1, first + steps])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    return points, triangles


def borders(triangles):
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    assert uses.max() <= 2
    return {tuple(edge) for edge in unique[uses == 1]}


@pytest.mark.parametrize("tolerance_mm", [0.3, 1.5])
def test_a_thinned_surface_stays_where_it_was_and_has_no_hole(tolerance_mm):
    points, triangles = dome()
    left = simplified(points, triangles, tolerance_mm, 60.0, 0.05)
    assert len(left) < 0.8 * len(triangles)
    assert borders(left) == borders(triangles)
    # Every vertex of before lies near the surface that is left.
    a, b, c = (points[left[:, k]].astype(float) for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    height = np.abs(np.einsum("tk,vtk->vt", normals, points[:, None] - a))
    middle = (a + b + c) / 3
    near = np.argsort(np.linalg.norm(points[:, None] - middle, axis=2), axis=1)[:, :12]
    assert np.take_along_axis(height, near, 1).min(axis=1).max() < 3 * tolerance_mm


def test_more_tolerance_leaves_fewer_triangles_and_a_flat_sheet_hardly_any():
    points, triangles = dome()
    counts = [len(simplified(points, triangles, t, 60.0, 0.05)) for t in (0.0, 0.2, 0.8, 3.0)]
    assert counts[0] == len(triangles)
    assert counts == sorted(counts, reverse=True) and counts[3] < counts[1]
    flat = points * np.array([1, 1, 0], np.float32)
    assert len(simplified(flat, triangles, 0.2, 200.0, 0.01)) < 0.3 * len(triangles)
    assert len(simplified(flat, triangles, 0.2, 6.0, 0.01)) > 0.9 * len(triangles)


def test_a_thinned_part_draws_the_same_vertices_in_another_order():
    points, triangles = dome()
    rows = np.arange(len(points), dtype=np.int32)[::-1].copy()
    extra = np.tile(points[:, :1], (1, 4))
    part = Part(Material("plain", WHITE), rows, points[:, :2] / 120, extra, triangles)
    neutral = points[::-1].copy()
    thin = thinned(part, neutral)
    assert len(thin.rows) < len(part.rows)
    place = neutral[thin.rows]
    np.testing.assert_array_equal(thin.uv, place[:, :2] / 120)
    np.testing.assert_array_equal(thin.extra[:, 0], place[:, 0])
    assert np.unique(thin.triangles).tolist() == list(range(len(thin.rows)))
    # The front is drawn first.
    z = place[thin.triangles][..., 2].mean(axis=1)
    assert z[: len(z) // 4].max() < z[-len(z) // 4 :].min()
    mouth = Part(Material("wet", WHITE, in_mouth=True), rows, part.uv, extra, triangles)
    assert len(thinned(mouth, neutral).triangles) == len(triangles)


def test_what_is_drawn_around_a_straight_run_of_values_may_go_and_a_bend_may_not(rng):
    points, triangles = dome()
    straight = points @ rng.normal(size=(3, 2)) + 7
    assert bends(points, triangles, straight).max() < 0.05 * np.ptp(straight)
    bent = np.where(points[:, :1] > 0, points[:, :1], 0.0)
    far = bends(points, triangles, bent)
    spacing = 120 / 23
    at_bend = np.abs(points[:, 0]) < spacing
    assert far[at_bend].min() > 0.1 * spacing > 10 * far[np.abs(points[:, 0]) > 2 * spacing].mean()


def test_strands_of_a_texture_keep_their_curls():
    points, triangles = dome()
    texture = np.zeros((100, 100, 3), np.uint8)
    rows, extra = np.arange(len(points), dtype=np.int32), np.ones((len(points), 4))

    def left(curl):
        uv = points[:, :2] / 120 + curl * np.sin(points[:, 1:2] / 4)
        return len(
            thinned(Part(Material("plain", texture), rows, uv, extra, triangles), points).rows
        )

    assert left(0.3) > left(0.1) > 1.2 * left(0.0)
    assert left(0.3) > 0.8 * len(points)
