import numpy as np
import pytest
from PySide6.QtGui import QImage

from app.views.layers import LOST_COLOR, POINT_COLOR, Points
from app.views.picture_view import PictureView, image_from_array


@pytest.fixture
def view(qtbot):
    widget = PictureView("Picture")
    qtbot.addWidget(widget)
    # The device pixels of a picture of 64 x 48, ten for each of its own.
    widget.resize(640, 520)
    return widget


def screen(widget):
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGBX8888)
    return np.frombuffer(image.constBits(), np.uint8).reshape(520, 640, 4)[..., :3].astype(int)


def half_bright():
    picture = np.full((48, 64, 3), 40, np.uint8)
    picture[:, :32] = 220
    return image_from_array(picture)


def center_of(mask):
    rows, columns = np.nonzero(mask)
    return columns.mean(), rows.mean()


def close_to(pixels, color, within=60):
    return np.abs(pixels - [color.red(), color.green(), color.blue()]).max(axis=2) < within


@pytest.mark.parametrize("channels", [3, 4])
def test_an_image_keeps_its_colours_when_the_array_is_gone(channels):
    pixels = np.zeros((5, 7, channels), np.uint8)
    pixels[..., :3], pixels[..., 3:] = (10, 120, 230), 255
    image = image_from_array(pixels[:, ::-1])
    pixels[:] = 0
    assert (image.width(), image.height()) == (7, 5)
    assert image.pixelColor(6, 4).getRgb() == (10, 120, 230, 255)


def test_the_picture_keeps_its_shape_and_lies_in_the_middle(view):
    view.show_image(half_bright())
    pixels = screen(view)
    assert (pixels[:18].max(), pixels[-18:].max()) == (37, 37)
    assert pixels[260, 100].tolist() == [220] * 3 and pixels[260, 540].tolist() == [40] * 3
    view.show_image(None)
    assert screen(view).max() == 37


def test_points_lie_on_the_middle_of_their_pixel_and_are_mirrored_with_the_picture(view):
    view.show_image(half_bright(), [Points(np.array([[50.0, 10.0]]))])
    # Pixel (50, 10) covers 500 to 510 and, below the surround of 20, 120 to 130.
    assert center_of(close_to(screen(view), POINT_COLOR)) == pytest.approx((504.5, 124.5), abs=0.6)
    view.set_mirrored(True)
    pixels = screen(view)
    assert center_of(close_to(pixels, POINT_COLOR)) == pytest.approx((134.5, 124.5), abs=0.6)
    assert pixels[260, 540].tolist() == [220] * 3


def test_doubtful_points_and_their_curves_are_drawn_in_the_warning_colour(view):
    points = np.array([[40.0, 10.0], [60.0, 10.0]])
    view.show_image(half_bright(), [Points(points, ((0, 1),), certain=False)])
    pixels = screen(view)
    # A line of one pixel that lies between two rows is drawn half into each.
    assert close_to(pixels, LOST_COLOR, within=130)[122:128, 410:600].any(axis=0).all()
    assert not close_to(pixels, POINT_COLOR).any()


def test_the_badge_is_at_the_lower_edge_and_not_mirrored(view):
    view.show_image(half_bright())
    before = screen(view)
    view.show_image(half_bright(), badge="Searching")
    after = screen(view)
    rows, columns = np.nonzero(np.abs(after - before).max(axis=2) > 20)
    assert rows.min() > 420 and rows.max() < 500
    assert columns.min() > 200 and columns.max() < 440
    view.set_mirrored(True)
    middle = np.s_[rows.min() + 4 : rows.max() - 4, columns.min() + 20 : columns.max() - 20]
    np.testing.assert_allclose(screen(view)[middle], after[middle], atol=40)


def test_a_view_without_a_picture_shows_only_the_surround(view):
    assert len(np.unique(screen(view).reshape(-1, 3), axis=0)) == 1
