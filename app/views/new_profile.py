"""The dialog that asks from what a profile is to be made, and its name."""

from collections.abc import Callable, Collection
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.views.choice import Choice
from app.views.files import ask_for_folder, ask_for_video

GUIDED = (
    "Best: let yourself be asked for up to 60 faces and head turns. The pictures are taken by "
    "themselves; it takes about ten minutes."
)
ADVICE = (
    "Or record one minute with the webcam you will use: look straight ahead with a relaxed face, "
    "turn the head slowly to all sides, then speak and make all the faces you can, also with "
    "the head turned. Light from the front helps. Everything stays on this computer."
)


class NewProfileDialog(QDialog):
    """Says what is wrong while it is typed; emits the wish when all is well."""

    wanted = Signal(str, str)  # name, source
    guided_wanted = Signal()

    def __init__(
        self,
        trouble: Callable[[str], str],
        taken: Collection[str],
        extra: Choice,
        parent: QWidget | None = None,
    ) -> None:
        """Ask.

        Args:
            trouble: Returns what is wrong with a name, or an empty text.
            taken: Names of the profiles that there are.
            extra: A source that is no file.
            parent: The window.
        """
        super().__init__(parent)
        self.setWindowTitle("New profile")
        self._trouble, self._taken, self._extra = trouble, taken, extra
        self.source, self.name, self._remark = QLineEdit(), QLineEdit(), QLabel()
        self._build()
        self.source.textChanged.connect(self._on_source_changed)
        self.name.textChanged.connect(self._judge)
        self.accepted.connect(lambda: self.wanted.emit(self._name(), self._source()))
        self._judge()

    @property
    def remark(self) -> str:
        """What is said about the input."""
        return self._remark.text()

    def _name(self) -> str:
        return self.name.text().strip()

    def _source(self) -> str:
        text = self.source.text().strip()
        return self._extra.key if text == self._extra.text else text

    def _build(self) -> None:
        guided = QPushButton("&Guided setup with the camera…")
        guided.setDefault(True)
        guided.clicked.connect(self._on_guided)
        best = QLabel(GUIDED)
        best.setWordWrap(True)
        advice = QLabel(ADVICE)
        advice.setWordWrap(True)
        self.source.setPlaceholderText("A video file or a folder of pictures")
        self.name.setPlaceholderText("For example your first name")
        self._remark.setWordWrap(True)
        self._remark.setMinimumHeight(2 * self.fontMetrics().lineSpacing())
        form = QFormLayout()
        form.addRow("&Source", self.source)
        form.addRow("", self._make_browsers())
        form.addRow("&Name", self.name)
        boxes = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(boxes.Ok | boxes.Cancel)
        self.buttons.button(boxes.Ok).setText("&Make profile")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setSpacing(12)
        layout.addWidget(best)
        layout.addWidget(guided)
        layout.addWidget(_line())
        layout.addWidget(advice)
        layout.addLayout(form)
        layout.addWidget(self._remark)
        layout.addWidget(self.buttons)
        self.setMinimumWidth(70 * self.fontMetrics().averageCharWidth())

    def _on_guided(self) -> None:
        self.reject()
        self.guided_wanted.emit()

    def _make_browsers(self) -> QWidget:
        row = QWidget()
        layout = QHBoxLayout(row)
        layout.setContentsMargins(0, 0, 0, 0)
        title = "Choose a video of your face"
        for text, answer in (
            ("&Video…", lambda: ask_for_video(self, title, self.source.setText)),
            ("&Folder…", lambda: ask_for_folder(self, "Choose pictures", self.source.setText)),
            (self._extra.text, lambda: self.source.setText(self._extra.text)),
        ):
            button = QPushButton(text)
            button.setAutoDefault(False)
            button.clicked.connect(answer)
            layout.addWidget(button)
        layout.addStretch(1)
        return row

    def _on_source_changed(self) -> None:
        """Suggest the source's name as the profile's, unless the user gave one."""
        if not self.name.isModified():
            self.name.setText(Path(self.source.text().strip()).stem)
        self._judge()

    def _judge(self) -> None:
        remark, good = self._verdict()
        self._remark.setText(remark)
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(good)

    def _verdict(self) -> tuple[str, bool]:
        source, name = self._source(), self._name()
        if not source:
            return "Choose a video or a folder of pictures.", False
        if source != self._extra.key and not Path(source).expanduser().exists():
            return f"There is no file or folder {source}.", False
        if not name:
            return "Give the profile a name.", False
        trouble = self._trouble(name)
        if trouble:
            return trouble[:1].upper() + trouble[1:], False
        if name in self._taken:
            return f"The profile {name} will be replaced when the new one is complete.", True
        return "Making a profile takes one to two minutes.", True


def _line() -> QFrame:
    line = QFrame()
    line.setFrameShape(QFrame.Shape.HLine)
    line.setFrameShadow(QFrame.Shadow.Sunken)
    return line
