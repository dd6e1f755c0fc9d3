"""Facts about texts that leave out what there is nothing to say of."""

import pytest

from app.controllers.shelving import _contents
from app.shelf import Shelved
from app.views.setup.train_page import TrainPage
from app.views.setup.training_plots import ResidualPlot


@pytest.mark.parametrize(
    "n_pictures, trained, told",
    [
        (0, False, "The empty profile"),
        (0, True, "The trained model"),
        (1, False, "1 picture and its landmarks"),
        (3, True, "3 pictures, their landmarks and the trained model"),
    ],
)
def test_what_is_deleted_is_what_is_there(n_pictures, trained, told):
    found = object.__new__(Shelved)
    object.__setattr__(found, "n_pictures", n_pictures)
    object.__setattr__(found, "trained", trained)
    assert _contents(found) == told


def test_the_worst_pictures_stand_below_the_plot(qtbot):
    plot = ResidualPlot()
    qtbot.addWidget(plot)
    names = ["pose_yaw+0", "smile_yaw-30", "grin_yaw+0", "pose_yaw-30"]
    plot.show_residuals([0.1, 3.0, 2.0, 1.0], names)
    below = plot.getAxis("bottom").labelText
    assert below == "picture (worst: smile (30° right), grin, turn 30° right)"
    plot.show_residuals([])
    assert plot.getAxis("bottom").labelText == "picture"


def test_plots_take_no_room_before_there_is_something_to_plot(qtbot):
    page = TrainPage()
    qtbot.addWidget(page)
    page.show_plots(False)
    assert not any(plot.isVisibleTo(page) for plot in page.plots)
    page.begin({"Fitting": 1.0})
    assert all(plot.isVisibleTo(page) for plot in page.plots)
