"""The live window with everything that plugs into it.

Each feature makes its own controller here, in one line; the controller adds its panel, menu entries
and listeners itself, and lives as long as its parent, the live controller:

    ControlPanel(controller, window, tools)

What the window and the live controller offer is told in app.views.live_window and
app.controllers.live.
"""

from app.controllers.arranging import Arranging
from app.controllers.controlling import Controlling
from app.controllers.correcting import CorrectingController
from app.controllers.correction_tools import CorrectionWorkshop
from app.controllers.helping import attach_help
from app.controllers.idling import Idling
from app.controllers.light_offer import LightOffer
from app.controllers.live import LiveController
from app.controllers.looking import Looking
from app.controllers.own_avatar import OwnAvatar
from app.controllers.playback import Playback
from app.controllers.plotting import Plotting
from app.controllers.takes import TakesController
from app.controllers.tools import Tools
from app.views.live_window import LiveWindow


def open_desk(tools: Tools) -> tuple[LiveWindow, LiveController]:
    """Return the live window and its controller, not started yet."""
    window = LiveWindow()
    return window, furnish(window, tools)


def furnish(window: LiveWindow, tools: Tools) -> LiveController:
    """Return the controller of a window that has none, with all features plugged in."""
    controller = LiveController(window, tools)
    arranging = Arranging(controller, window)
    attach_panels(controller, window, tools)
    # Panels that are not there yet cannot be put where they were.
    arranging.restore()
    return controller


def attach_panels(controller: LiveController, window: LiveWindow, tools: Tools) -> None:
    """Plug all features into the window.

    Args:
        controller: Joins window and threads; parent of what is made here.
        window: Gets panels and menu entries.
        tools: What the features need of the rest of the program.
    """
    attach_help(window)
    Controlling(controller, window)
    Idling(controller)
    Looking(controller, window)
    OwnAvatar(controller, window, tools.profile_folder)
    Playback(controller, window)
    Plotting(controller, window)
    TakesController(controller, window)
    CorrectingController(controller, window, CorrectionWorkshop(tools))
    LightOffer(controller, window)
