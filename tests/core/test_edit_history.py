"""Facts about undo and redo."""

import numpy as np

from core.edit_history import Change, EditHistory
from core.records import Landmarks2D


def landmarks(value):
    return Landmarks2D(
        np.full((75, 2), value), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2)
    )


def change(number):
    return Change("smile", f"change {number}", landmarks(number), landmarks(number + 1))


def test_changes_come_back_in_the_opposite_order_without_limit():
    history, changes = EditHistory(), [change(n) for n in range(500)]
    for one in changes:
        history.add(one)
    assert [history.undo() for _ in changes] == changes[::-1]
    assert history.undo() is None and history.next_undo == ""
    assert [history.redo() for _ in changes] == changes
    assert history.redo() is None


def test_a_new_change_ends_what_could_be_redone():
    history = EditHistory()
    history.add(change(1))
    history.undo()
    assert history.next_redo == "change 1"
    history.add(change(2))
    assert history.next_redo == "" and history.redo() is None
    assert history.next_undo == "change 2"
