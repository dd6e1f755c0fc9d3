"""Facts about adding pictures to a trained profile from the guided setup."""

import pytest

from app.controllers.contact import cell_of
from app.workbook import Workbook
from tests.app.test_setup_wizard import begin, people, setup, shoot  # noqa: F401  fixtures


@pytest.mark.parametrize("key", ["light", "glasses", "hand"])
def test_the_training_page_leads_to_the_prompts_of_a_set(qtbot, setup, key):  # noqa: F811
    begin(qtbot, setup)
    shoot(qtbot, setup, 14)
    setup.controller.show("train")
    actions = setup.window.train.more_button.menu().actions()
    actions[["light", "glasses", "hand"].index(key)].trigger()
    assert setup.controller.step == "capture"
    assert setup.controller.capturing.shot.name.startswith(f"{key}~")
    setup.window.close()


def test_a_picture_of_a_set_joins_the_profile(qtbot, setup):  # noqa: F811
    begin(qtbot, setup)
    shoot(qtbot, setup, 14)
    setup.controller.add_pictures("glasses")
    setup.tools.obeys = True
    there = setup.root / "me"
    qtbot.waitUntil(
        lambda: any("glasses~" in name for name in Workbook(there, lambda rgb: None).names),
        timeout=8000,
    )
    setup.tools.obeys = False
    setup.window.close()


def test_without_a_profile_no_pictures_are_asked_for(qtbot, setup):  # noqa: F811
    setup.controller.add_pictures("light")
    assert setup.controller.step == "start"
    setup.window.close()


def test_a_picture_that_is_left_out_is_marked_on_the_contact_sheet(qtbot, setup):  # noqa: F811
    begin(qtbot, setup)
    shoot(qtbot, setup, 3)
    book = Workbook(setup.root / "me", lambda rgb: None)
    name = book.names[0]
    assert cell_of(book, name).state == "good"
    book.take_out(name)
    assert cell_of(book, name).state == "weak" and "left out" in cell_of(book, name).note
    setup.window.close()
