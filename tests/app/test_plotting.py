"""Plots on demand."""

import numpy as np
import pytest
from PySide6.QtGui import QColor, QPalette

from app.controllers.desk import open_desk
from app.controllers.plotting import LONGEST_MS, N_COEFFICIENTS, Plotting, counted, liveliest
from tests.app.live_fakes import FakeToolbox


@pytest.fixture
def desk(qtbot):
    window, controller = open_desk(FakeToolbox(profiles=["anna"]))
    qtbot.addWidget(window)
    window.show()
    controller.start()
    yield window, controller.findChild(Plotting)
    window.close()


@pytest.mark.parametrize(
    ("key", "plot", "names"),
    [
        ("plot_head", "angles", ("yaw", "pitch", "roll")),
        ("plot_times", "times", ("solve", "latency")),
    ],
)
def test_a_plot_fills_once_its_panel_is_open(desk, qtbot, key, plot, names):
    window, plotting = desk
    assert not getattr(plotting, plot).built
    window.panels.show(key)
    qtbot.waitUntil(lambda: getattr(plotting, plot).names == names, timeout=20_000)


def test_nothing_is_remembered_or_plotted_while_no_plot_is_open(desk, qtbot):
    window, plotting = desk
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    qtbot.wait(200)
    assert len(plotting._rows) == 0
    window.panels.show("plot_coefficients")
    qtbot.waitUntil(lambda: len(plotting.coefficients.names) == N_COEFFICIENTS, timeout=20_000)
    window.panels.dock("plot_coefficients").hide()
    qtbot.wait(250)
    held = len(plotting._rows)
    shown = plotting.coefficients._lines[0].getData()[0]
    qtbot.wait(250)
    assert len(plotting._rows) == held
    np.testing.assert_array_equal(plotting.coefficients._lines[0].getData()[0], shown)


def test_plots_follow_the_theme(desk, qtbot):
    window, plotting = desk
    window.panels.show("plot_head")
    qtbot.waitUntil(lambda: plotting.angles.names != (), timeout=20_000)
    for ground in (QColor(20, 22, 24), QColor(250, 250, 250)):
        palette = QPalette(window.palette())
        palette.setColor(QPalette.ColorRole.Base, ground)
        plotting.angles.setPalette(palette)
        image = plotting.angles.grab().toImage()
        seen = [
            image.pixel(x, y)
            for x in range(0, image.width(), 7)
            for y in range(0, image.height(), 3)
        ]
        # Beside grid, axes and curves.
        assert seen.count(ground.rgb()) > len(seen) // 3


def test_the_coefficients_that_moved_most_are_plotted_in_their_usual_order():
    values = np.zeros((5, 46))
    values[:, 40] = np.linspace(0, 1, 5)
    values[:, 3] = np.linspace(0, 0.5, 5)
    found = liveliest(values)
    assert {3, 40} <= set(found) and found == sorted(found) and len(found) == N_COEFFICIENTS


def test_times_are_counted_and_long_ones_are_not_left_out():
    curve = counted("solve", [0.5, 4.2, 4.9, 900.0])
    assert curve.y.sum() == 4 and curve.y[4] == 2 and curve.y[-1] == 1
    assert curve.x[-1] == LONGEST_MS and len(curve.x) == len(curve.y) + 1
