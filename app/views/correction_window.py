"""The landmark editor on one frozen frame of the live view."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout

from app.views.editor.editor_window import EditorWindow

ADVICE = (
    "Drag what is wrong to where it is; R lets the face model move the rest with it. The live view "
    "goes on meanwhile."
)
#: Deeds for which other pictures are needed.
OTHER_PICTURES = ("previous", "similar", "mirror", "back", "forth")


class CorrectionWindow(EditorWindow):
    """Shows one frame; says whether it is to be used."""

    use_wanted = Signal()

    def __init__(self, profile: str) -> None:
        """Prepare the window for a frame of who has this profile."""
        super().__init__(profile)
        self.setWindowTitle(f"This frame is wrong – {profile} – facepuppet")
        self.use_button, self.cancel_button = QPushButton("&Use it"), QPushButton("&Cancel")
        self.use_button.setToolTip("Add the frame to the profile and train it in the background")
        self.use_button.setDefault(True)
        self.cancel_button.setToolTip("Leave everything as it was")
        for widget in (self.strip, self.outdated_label, self.retrain_button):
            widget.hide()
        self._add_foot()
        self.use_button.clicked.connect(self.use_wanted)
        self.cancel_button.clicked.connect(self.close)

    def show_deed(self, key: str, possible: bool, text: str = "") -> None:
        """Say whether something can be done now; what needs other pictures never can."""
        super().show_deed(key, possible and key not in OTHER_PICTURES, text)

    def _add_foot(self) -> None:
        for key in OTHER_PICTURES:
            self.show_deed(key, False)
        advice = QLabel(ADVICE)
        advice.setWordWrap(True)
        row = QHBoxLayout()
        row.addWidget(advice, stretch=1)
        row.addWidget(self.cancel_button)
        row.addWidget(self.use_button)
        center = self.centralWidget()
        layout = None if center is None else center.layout()
        if isinstance(layout, QVBoxLayout):
            layout.addLayout(row)
