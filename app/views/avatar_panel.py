"""The panel that says how the avatar is seen: view, mirror, background, lights, edges."""

import math
from pathlib import Path

from PySide6.QtCore import QStandardPaths, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QIcon, QPixmap
from PySide6.QtWidgets import (
    QColorDialog,
    QFileDialog,
    QFormLayout,
    QGroupBox,
    QLabel,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from app.render.look import AvatarLook, Background, Color
from app.views.choice import Choice
from app.views.chooser import Chooser
from app.views.labelled_slider import LabelledSlider

FRAMING_CHOICES = (
    Choice("shoulders", "Head and shoulders"),
    Choice("bust", "Whole bust"),
    Choice("close", "Close-up of the face"),
)
MIRROR_CHOICES = (
    Choice("source", "Like the webcam picture", "What the switch Mirror says for both pictures"),
    Choice("yes", "Always", "The avatar does what your mirror image would do"),
    Choice("no", "Never", "The avatar is seen as others see you"),
)
BACKGROUND_CHOICES = (
    Choice("studio", "Studio wall"),
    Choice("blurred", "Webcam, blurred"),
    Choice("color", "Colour"),
    Choice("picture", "Picture"),
    Choice("key", "Chroma key", "One pure colour with sharp edges, to be keyed out elsewhere"),
    Choice("transparent", "Transparent", "See-through in the avatar's own window (F9)"),
)
LIGHT_TEXTS = {
    "studio": "Studio",
    "window": "Soft window",
    "ring": "Ring light",
    "dramatic": "Dramatic side light",
    "sunset": "Sunset",
    "neon": "Neon",
    "night": "Night",
}
SAMPLES_CHOICES = (
    Choice("0", "As fast as can be"),
    Choice("2", "Smooth (2 samples)"),
    Choice("4", "Smoother (4 samples)"),
    Choice("8", "Smoothest (8 samples)"),
)
NO_PICTURE_TEXT = "Choose a picture…"
PICTURES = ["Pictures (*.png *.jpg *.jpeg *.webp *.bmp *.tif *.tiff)", "All files (*)"]


class AvatarPanel(QScrollArea):
    """Shows a look; says what the user wishes instead."""

    look_wanted = Signal(object)  # AvatarLook
    mirror_wanted = Signal(str)
    picture_wanted = Signal(str)  # path
    view_reset_wanted = Signal()
    all_reset_wanted = Signal()

    def __init__(self, lights: tuple[str, ...]) -> None:
        """Make the panel.

        Args:
            lights: The names of the lights that there are.
        """
        super().__init__()
        self._look, self._lights = AvatarLook(), lights
        self.framing, self.mirror = Chooser("Framing"), Chooser("Mirror")
        self.background, self.lights = Chooser("Background"), Chooser("Lights")
        self.samples = Chooser("Edges")
        self.turn = LabelledSlider("Turn", -180, 180, "°")
        self.tilt = LabelledSlider("Height", -34, 68, "°")
        self.zoom = LabelledSlider("Zoom", 40, 600, " %")
        self.brightness = LabelledSlider("Brightness", 30, 200, " %")
        self.color_button, self.picture_button = QPushButton(), QPushButton(NO_PICTURE_TEXT)
        self.reset_button = QPushButton("Reset view")
        self.all_button = QPushButton("Reset all")
        self.quality = QLabel()
        self.quality.setWordWrap(True)
        self.quality.setAccessibleName("Quality of the avatar's picture")
        self._name_widgets()
        self._build()
        self._connect()
        self.show_look(AvatarLook(), "source")

    def show_look(self, look: AvatarLook, mirror: str) -> None:
        """Show how the avatar is seen; emits nothing."""
        self._look = look
        self.framing.show_choices(FRAMING_CHOICES, look.framing)
        self.mirror.show_choices(MIRROR_CHOICES, mirror)
        self.background.show_choices(BACKGROUND_CHOICES, look.background.kind)
        lights = [Choice(name, LIGHT_TEXTS.get(name, name)) for name in self._lights]
        self.lights.show_choices(lights, look.lights)
        self.samples.show_choices(SAMPLES_CHOICES, str(look.samples))
        self.turn.show_value(round(math.degrees(look.yaw_rad)))
        self.tilt.show_value(round(math.degrees(look.pitch_rad)))
        self.zoom.show_value(round(100 * look.zoom))
        self.brightness.show_value(round(100 * look.brightness))
        self._show_background(look.background)

    def show_quality(self, text: str, samples_help: bool) -> None:
        """Say how well the avatar is drawn.

        Args:
            text: Where that is worth a word, or empty.
            samples_help: Whether asking for more samples has any effect.
        """
        self.quality.setText(text)
        self.quality.setVisible(bool(text))
        self.samples.setEnabled(samples_help)

    # -- construction --------------------------------------------------------------------

    def _name_widgets(self) -> None:
        for widget, tip in (
            (self.turn, "The way round the avatar"),
            (self.tilt, "See the avatar from above or from below"),
            (self.reset_button, "See the avatar from the front again (double click on it)"),
            (self.all_button, "Forget all that was chosen here for this avatar"),
        ):
            widget.setToolTip(tip)
        self.color_button.setAccessibleName("Colour of the background")
        self.picture_button.setAccessibleName("Picture of the background")

    def _build(self) -> None:
        content = QWidget()
        layout = QVBoxLayout(content)
        for group in (
            _group(
                "View", ("Framing", self.framing), ("Turn", self.turn), ("Height", self.tilt),
                ("Zoom", self.zoom), ("", self.reset_button), ("Mirror", self.mirror),
            ),
            _group(
                "Background", ("Kind", self.background), ("", self.color_button),
                ("", self.picture_button),
            ),
            _group("Light", ("Lights", self.lights), ("Brightness", self.brightness)),
            _group("Drawing", ("Edges", self.samples), ("", self.quality)),
        ):  # fmt: skip
            layout.addWidget(group)
        layout.addWidget(self.all_button)
        layout.addStretch(1)
        self.setWidget(content)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFrameShape(QScrollArea.Shape.NoFrame)
        self.setMinimumWidth(280)

    def _connect(self) -> None:
        wish = self._wish
        self.framing.chosen.connect(lambda key: wish(framing=key))
        self.mirror.chosen.connect(self.mirror_wanted)
        self.background.chosen.connect(self._on_background_chosen)
        self.lights.chosen.connect(lambda key: wish(lights=key))
        self.samples.chosen.connect(lambda key: wish(samples=int(key)))
        self.turn.moved.connect(lambda value: wish(yaw_rad=math.radians(value)))
        self.tilt.moved.connect(lambda value: wish(pitch_rad=math.radians(value)))
        self.zoom.moved.connect(self._on_zoom_moved)
        self.brightness.moved.connect(lambda value: wish(brightness=value / 100))
        self.color_button.clicked.connect(self.ask_for_color)
        self.picture_button.clicked.connect(self.ask_for_picture)
        self.reset_button.clicked.connect(lambda: self.view_reset_wanted.emit())
        self.all_button.clicked.connect(lambda: self.all_reset_wanted.emit())

    # -- wishes --------------------------------------------------------------------------

    def _wish(self, **values: object) -> None:
        self.look_wanted.emit(self._look.changed(**values))

    def _wish_background(self, **values: object) -> None:
        self._wish(background=self._look.background.changed(**values))

    def _on_zoom_moved(self, value: int) -> None:
        """Enlarge about the middle of what is seen."""
        self.look_wanted.emit(self._look.zoomed(value / 100 / self._look.zoom))

    def _on_background_chosen(self, kind: str) -> None:
        if kind == "picture" and not self._look.background.picture:
            self.ask_for_picture()
        else:
            self._wish_background(kind=kind)

    def ask_for_color(self) -> QColorDialog:
        """Let the user choose the colour, and show each one that is tried."""
        background = self._look.background
        field = "key" if background.kind == "key" else "color"
        before: Color = getattr(background, field)
        dialog = QColorDialog(QColor(*before), self)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)

        def show(color: QColor) -> None:
            self._wish_background(**{field: (color.red(), color.green(), color.blue())})

        dialog.currentColorChanged.connect(show)
        dialog.rejected.connect(lambda: show(QColor(*before)))
        dialog.open()
        return dialog

    def ask_for_picture(self) -> QFileDialog:
        """Let the user choose a picture file."""
        kept = Path(self._look.background.picture)
        places = QStandardPaths.standardLocations(QStandardPaths.StandardLocation.PicturesLocation)
        folder = str(kept.parent) if kept.is_file() else (places[0] if places else "")
        dialog = QFileDialog(self, "Background picture", folder)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        dialog.setNameFilters(PICTURES)
        dialog.fileSelected.connect(self.picture_wanted)
        dialog.rejected.connect(self.background.show_current)
        dialog.open()
        return dialog

    def _show_background(self, background: Background) -> None:
        colored = background.kind in ("color", "key")
        color = QColor(*(background.key if background.kind == "key" else background.color))
        swatch = QPixmap(28, 16)
        swatch.fill(color)
        self.color_button.setIcon(QIcon(swatch))
        self.color_button.setText(f"{color.name()}…")
        self.color_button.setVisible(colored)
        path = background.picture
        text = Path(path).name if path else NO_PICTURE_TEXT
        metrics = QFontMetrics(self.picture_button.font())
        self.picture_button.setText(metrics.elidedText(text, Qt.TextElideMode.ElideMiddle, 170))
        self.picture_button.setToolTip(path)
        self.picture_button.setVisible(background.kind == "picture")


def _group(title: str, *rows: tuple[str, QWidget]) -> QGroupBox:
    """Return a frame with labelled rows."""
    group = QGroupBox(title)
    form = QFormLayout(group)
    form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
    form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.DontWrapRows)
    for text, field in rows:
        if text:
            form.addRow(text, field)
        else:
            form.addRow(field)
    return group
