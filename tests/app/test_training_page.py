"""Facts about the training page at work, on real widgets."""

import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPalette

from app.controllers import training as training_module
from app.controllers.report_export import FILTERS, ReportUnwritableError, write_report
from app.controllers.training import TrainingController
from app.report import report_html
from app.views.setup.stage_list import DONE, RUNNING, WAITING
from app.views.setup.train_page import TrainPage
from app.workbook import Workbook
from core.errors import CoreError
from core.extra_shots import SETS
from core.pipeline import LABELS, stage_shares
from core.records import Progress
from tests.app.test_editor import film, folder  # noqa: F401  fixtures
from tests.app.test_report import REPORT

CURVES = {"training_px": [9.0, 5.0, 2.0], "held_out_px": [9.5, 6.0, 3.0]}
FULL = REPORT | {
    "held_out": REPORT["held_out"] | {"stages": CURVES}, "stages": {"all_px": [9.0, 4.0, 1.5]},
    "focal_curve": [[400.0, 9.0], [600.0, 5.0]], "picture_rms_px_at_640": [1.0, 2.0, 3.0],
}  # fmt: skip


class Steps:
    """A training that does what the test says, step by step."""

    def __init__(self):
        self.steps, self.error, self.waits = [], None, False

    def __call__(self, book):
        yield from self.steps
        while self.waits:
            # Faster than they are shown, they would pile up.
            time.sleep(0.02)
            yield self.steps[-1]
        if self.error is not None:
            raise self.error
        return "Trained."


@pytest.fixture
def desk(qtbot, folder, monkeypatch):  # noqa: F811
    monkeypatch.setattr(training_module, "LEAST_PICTURES", 3)
    book = Workbook(folder, lambda rgb: None)
    book.profile = replace(book.profile, report=FULL)
    page, steps = TrainPage(), Steps()
    qtbot.addWidget(page)
    page.resize(1100, 640)
    page.show()
    controller = TrainingController(page, steps)
    controller.show(book)
    yield SimpleNamespace(page=page, controller=controller, steps=steps, book=book)
    steps.waits = False
    controller.stop()


def train(qtbot, desk):
    desk.page.train_button.click()
    qtbot.waitUntil(lambda: not desk.controller.busy, timeout=5000)


def drawn(plot_item):
    return [] if plot_item.yData is None else plot_item.yData.tolist()


def test_the_last_training_is_shown_with_all_its_plots(desk):
    page = desk.page
    assert page.left.currentWidget() is page.report
    assert "0.66 px" in page.report.toPlainText()
    assert drawn(page.focal_plot.curve) == [9.0, 5.0]
    curves = page.stage_plot.curves
    assert drawn(curves["training_px"]) == CURVES["training_px"]
    assert drawn(curves["held_out_px"]) == CURVES["held_out_px"]
    assert drawn(curves["all_px"]) == [9.0, 4.0, 1.5]
    assert list(page.residual_plot.bars.opts["height"]) == [1.0, 2.0, 3.0]
    assert page.train_button.text() == "&Train again"


def test_stages_are_listed_with_progress_while_they_are_at_work(qtbot, desk):
    page, labels = desk.page, list(LABELS.values())
    shares = stage_shares(False)
    first = shares[labels[0]] + shares[labels[1]] + shares[labels[2]]
    half = first + shares[labels[3]] / 2
    desk.steps.steps = [Progress(round(1000 * half), 1000, labels[3])]
    desk.steps.waits = True
    page.train_button.click()
    assert page.left.currentWidget() is not page.report
    assert list(page.stages.states()) == labels
    qtbot.waitUntil(lambda: page.stages.states()[labels[3]] == RUNNING, timeout=5000)
    states, percents = page.stages.states(), page.stages.percents()
    assert [states[label] for label in labels] == [DONE, DONE, DONE, RUNNING, WAITING]
    assert percents[labels[0]] == 100 and percents[labels[4]] == 0
    assert percents[labels[3]] == pytest.approx(50, abs=1)
    assert not page.train_button.isEnabled() and not page.job_row.isHidden()


def test_errors_of_stages_are_plotted_while_they_are_trained(qtbot, desk):
    desk.steps.steps = [
        Progress(300 + n, 1000, LABELS["held_out"],
                 {"stage": n, "left_mm": 3.0, "training_px": 9 - n, "held_out_px": 9.5 - n})
        for n in range(3)
    ]  # fmt: skip
    desk.steps.waits = True
    desk.page.train_button.click()
    curves = desk.page.stage_plot.curves
    qtbot.waitUntil(lambda: len(drawn(curves["held_out_px"])) >= 3, timeout=5000)
    assert drawn(curves["training_px"])[:3] == [9, 8, 7]
    assert drawn(curves["held_out_px"])[:3] == [9.5, 8.5, 7.5]
    assert drawn(curves["all_px"]) == []


def test_a_training_that_is_stopped_says_that_nothing_has_changed(qtbot, desk):
    desk.steps.steps, desk.steps.waits = [Progress(1, 1000, LABELS["calibrate"])], True
    desk.page.train_button.click()
    qtbot.waitUntil(lambda: desk.page.stages.states()[LABELS["calibrate"]] == RUNNING)
    desk.page.job_row.cancel_button.click()
    qtbot.waitUntil(lambda: not desk.controller.busy, timeout=5000)
    assert "stopped" in desk.page.message_bar.text
    assert desk.page.left.currentWidget() is desk.page.report
    assert drawn(desk.page.focal_plot.curve) == [9.0, 5.0]


def test_a_failure_stays_to_be_read_beside_the_last_report(qtbot, desk):
    desk.steps.steps = [Progress(1, 1000, LABELS["calibrate"])]
    desk.steps.error = CoreError("the fitting error still falls")
    train(qtbot, desk)
    assert "still falls" in desk.page.message_bar.text
    assert "profile is as it was" in desk.page.message_bar.text
    assert "0.66 px" in desk.page.report.toPlainText()
    desk.steps.error = None
    train(qtbot, desk)
    assert desk.page.message_bar.text == ""


def test_changed_landmarks_offer_to_train_again(desk):
    name = desk.book.names[0]
    desk.book.correct(name, desk.book.landmarks(name).moved(3, 5.0, 6.0))
    desk.controller.show(desk.book)
    assert "changed since the last training" in desk.page.status.text()
    assert desk.page.train_button.isEnabled()


def test_a_picture_that_was_taken_out_offers_to_train_again(desk):
    desk.book.take_out(desk.book.names[0])
    desk.controller.show(desk.book)
    assert "changed since the last training" in desk.page.status.text()


def test_plots_follow_the_theme(desk):
    dark = QPalette()
    dark.setColor(QPalette.ColorRole.Base, QColor(30, 30, 30))
    dark.setColor(QPalette.ColorRole.Text, QColor(238, 238, 238))
    for plot in desk.page.plots:
        assert plot.backgroundBrush().color().lightnessF() > 0.9
        plot.setPalette(dark)
        assert plot.backgroundBrush().color() == QColor(30, 30, 30)
        pen = plot.getAxis("left").textPen().color()
        assert pen.lightnessF() > 0.8
        image = plot.grab().toImage()
        corner = image.pixelColor(image.width() - 2, image.height() - 2)
        assert corner.lightnessF() < 0.3
        paper = plot.print_image()
        assert paper.pixelColor(3, 3) == QColor("white")
        assert plot.backgroundBrush().color() == QColor(30, 30, 30)


def test_a_bar_names_its_picture_and_a_click_opens_it(qtbot, desk):
    plot = desk.page.residual_plot
    assert plot.name_at(1.2) == "p1" and plot.name_at(-4) == "" and plot.name_at(99.0) == ""
    place = plot.getPlotItem().vb.mapViewToScene(QPointF(2.0, 1.0))
    with qtbot.waitSignal(desk.controller.picture_wanted) as wanted:
        plot.scene().sigMouseClicked.emit(SimpleNamespace(scenePos=lambda: place))
    assert wanted.args == ["p2"]
    plot.scene().sigMouseMoved.emit(place)
    assert plot.toolTip() == "p2"


def test_more_pictures_are_offered_by_sets(qtbot, desk):
    actions = desk.page.more_button.menu().actions()
    assert [action.text() for action in actions] == [one.title for one in SETS]
    with qtbot.waitSignal(desk.controller.more_wanted) as wanted:
        actions[1].trigger()
    assert wanted.args == ["glasses"]


def exported(desk, monkeypatch, path):
    asked = []

    def ask(parent, title, name, chosen, filters):
        asked.append((name, filters))
        chosen(str(path))

    monkeypatch.setattr(training_module, "ask_where_to_save", ask)
    desk.page.export_button.click()
    assert asked == [("me.html", FILTERS)]
    return desk.page.message_bar.text


def test_the_report_is_exported_as_a_page_with_its_plots(desk, monkeypatch, tmp_path):
    told = exported(desk, monkeypatch, tmp_path / "a.html")
    html = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert str(tmp_path / "a.html") in told
    assert html.count("data:image/png;base64,") == 3 and "href" not in html
    assert "73.3 %" in html


def test_the_report_is_exported_as_a_pdf_with_text_and_plots(desk, monkeypatch, tmp_path):
    exported(desk, monkeypatch, tmp_path / "a.pdf")
    content = (tmp_path / "a.pdf").read_bytes()
    assert content.startswith(b"%PDF-") and content.rstrip().endswith(b"%%EOF")
    assert content.count(b"/Type /Page\n") + content.count(b"/Type /Page ") >= 1
    assert content.count(b"/Subtype /Image") >= 3 and b"/ToUnicode" in content


def test_a_name_without_an_ending_becomes_a_page(qtbot, tmp_path):
    written = write_report(tmp_path / "mine.v2", "me", report_html("me", REPORT), {})
    assert written == tmp_path / "mine.v2.html" and written.exists()


@pytest.mark.parametrize("name", ["a.html", "a.pdf"])
def test_a_report_that_cannot_be_written_to_its_end_leaves_the_one_before(
    qtbot, monkeypatch, tmp_path, name
):
    path = write_report(tmp_path / name, "me", "", {})
    before = path.read_bytes()

    def full(self, *content, **settings):
        with self.open("wb") as file:
            file.write(b"half")
        raise OSError(28, "No space left on device")

    for how in ("write_bytes", "write_text"):
        monkeypatch.setattr(Path, how, full)
    with pytest.raises(ReportUnwritableError, match="no space left"):
        write_report(path, "me", "more", {})
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["a.html", "a.pdf"])
def test_where_no_report_can_be_written_is_told(qtbot, desk, monkeypatch, tmp_path, name):
    told = exported(desk, monkeypatch, tmp_path / "nowhere" / name)
    assert "annot write" in told and "no such file" in told
    with pytest.raises(ReportUnwritableError, match="Choose another"):
        write_report(Path(tmp_path / "nowhere" / name), "me", "", {})


def test_every_control_can_be_reached_and_has_a_name(desk):
    page = desk.page
    for button in (page.train_button, page.more_button, page.export_button, page.live_button):
        assert "&" in button.text() and button.focusPolicy() & Qt.FocusPolicy.TabFocus
    assert page.report.accessibleName() and all(plot.accessibleName() for plot in page.plots)
