"""Small print below the pictures: an invitation to the setup, or why a profile is not used."""

from collections.abc import Callable

from app.controllers.remarks import MAKING, STRANGER, UNUSABLE, FreeSpell
from app.views.live_window import LiveWindow
from core.records import FaceState


class Inviting:
    """Decides what is said; remembers whether the invitation was put away.

    Attributes:
        declined: It was, now or at an earlier start.
    """

    def __init__(self, window: LiveWindow, newcomer: Callable[[], bool]) -> None:
        """Prepare to invite.

        Args:
            window: Shows it.
            newcomer: Tells whether a source is played, or being opened, without any profile.
        """
        self._window, self._newcomer = window, newcomer
        self._spell = FreeSpell()
        self.declined, self._tracked = False, False
        window.card.dismissed.connect(self._on_dismissed)

    def look(self, profile: str, unusable: bool, making: bool, state: FaceState | None) -> None:
        """Say what is to be said now.

        Args:
            profile: The wanted one, or empty.
            unusable: Whether it cannot be loaded.
            making: Whether one is being made.
            state: The newest one.
        """
        stranger = self._spell.lasts(state)
        if unusable:
            hint = UNUSABLE
        elif profile:
            hint = STRANGER if stranger else ""
        else:
            hint = MAKING if making else ""
        self._window.show_hint(hint)
        newcomer = self._newcomer()
        # The card says that tracking works: not before it does; then it stays, whoever moves.
        sees_face = state is not None and not state.lost
        self._tracked = newcomer and (self._tracked or sees_face)
        self._window.card.setVisible(self._tracked and not making and not self.declined)

    def _on_dismissed(self) -> None:
        self.declined = True
