"""Questions before something is copied or deleted; none makes the program wait."""

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMessageBox,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

#: Looks that call for a profile of their own: what is put behind the name.
LOOKS = {"With &glasses": "glasses", "With a &beard": "beard", "Evening &lamp": "lamp"}
WHY_COPY = (
    "A profile knows you as you looked in its pictures. If you sometimes wear glasses, have grown "
    "a beard, or sit under another lamp, make a copy for that: it begins with all pictures and "
    "with the model of <b>{name}</b>. Take some of the pictures again as you look now, and train "
    "it. <b>{name}</b> stays as it is."
)


def ask_to_confirm(
    parent: QWidget, title: str, text: str, yes: str, then: Callable[[], object]
) -> QMessageBox:
    """Ask before something that cannot be undone.

    Args:
        parent: The window to ask in.
        title: The question in short.
        text: What will be lost and what stays.
        yes: What the button that does it says.
        then: Called when it is pressed.
    """
    box = QMessageBox(QMessageBox.Icon.Warning, title, f"<b>{title}</b>", parent=parent)
    box.setInformativeText(text)
    box.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    button = box.addButton(yes, QMessageBox.ButtonRole.DestructiveRole)
    cancel = box.addButton(QMessageBox.StandardButton.Cancel)
    box.setDefaultButton(cancel)
    box.setEscapeButton(cancel)
    button.clicked.connect(lambda: then())
    box.open()
    return box


class CopyDialog(QDialog):
    """Asks for the name of a copy and says what copies are for."""

    def __init__(self, parent: QWidget, name: str, trouble: Callable[[str], str]) -> None:
        """Ask; `accepted` comes with a good name only.

        Args:
            parent: The window to ask in.
            name: Of the profile to copy.
            trouble: Returns what is wrong with a name, or an empty text.
        """
        super().__init__(parent)
        self.setWindowTitle(f"Copy {name} for another look")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._trouble = trouble
        names = [f"{name} {look}" for look in LOOKS.values()]
        free = next((one for one in names if not trouble(one)), names[0])
        self.name, self.remark = QLineEdit(free), QLabel()
        self.name.setAccessibleName("Name of the copy")
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.copy_button = self.buttons.addButton(
            "Make the &copy", QDialogButtonBox.ButtonRole.AcceptRole
        )
        self._build(name)
        self.name.textChanged.connect(self._judge)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self._judge()
        self.name.selectAll()
        self.name.setFocus()

    @property
    def chosen(self) -> str:
        """The name of the copy."""
        return self.name.text().strip()

    def _build(self, name: str) -> None:
        why = QLabel(WHY_COPY.format(name=name))
        why.setWordWrap(True)
        why.setMinimumWidth(52 * self.fontMetrics().averageCharWidth())
        label = QLabel("&Name of the copy")
        label.setBuddy(self.name)
        looks = QHBoxLayout()
        for text, look in LOOKS.items():
            button = QPushButton(text)
            button.setAutoDefault(False)
            button.clicked.connect(lambda _=False, look=look: self.name.setText(f"{name} {look}"))
            looks.addWidget(button)
        looks.addStretch(1)
        layout = QVBoxLayout(self)
        layout.addWidget(why)
        layout.addWidget(label)
        layout.addWidget(self.name)
        layout.addLayout(looks)
        layout.addWidget(self.remark)
        layout.addWidget(self.buttons)

    def _judge(self) -> None:
        trouble = self._trouble(self.chosen) if self.chosen else "a name is needed"
        self.remark.setText(trouble[:1].upper() + trouble[1:])
        self.copy_button.setEnabled(not trouble)
