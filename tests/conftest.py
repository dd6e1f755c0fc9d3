"""What all tests share: no screen, no user data of ours, nothing left open."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import app  # noqa: F401  sets what numba, OpenBLAS and OpenCV read at their first import

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import numpy as np
import pytest

REPOSITORY = Path(__file__).resolve().parent.parent

#: Tests of kernels that are quick enough to run again in plain Python, see `nojit`.
PLAIN_PYTHON_MODULES = {
    "test_animation_prior", "test_box_least_squares", "test_drive_filter", "test_drive_parts",
    "test_energy_kernels", "test_gaze", "test_pose_filter", "test_tracker", "test_training_set",
}  # fmt: skip


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that run a second time without numba's compiler."""
    for item in items:
        if item.path.stem in PLAIN_PYTHON_MODULES:
            item.add_marker(pytest.mark.nojit)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(1)


@pytest.fixture(scope="session")
def clips() -> Path:
    """The folder of real webcam clips, which are not part of this repository."""
    folder = Path(os.environ.get("FACEPUPPET_CLIPS", REPOSITORY.parent / "shared" / "clips"))
    if not (folder / "person_a_1.mp4").exists():
        pytest.skip(f"no real clips in {folder}; FACEPUPPET_CLIPS may name their folder")
    return folder


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty user data folder, so that no test sees or touches real profiles."""
    folder = tmp_path / "facepuppet-home"
    monkeypatch.setenv("FACEPUPPET_HOME", str(folder))
    return folder


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    """Fail a test that leaves a window open: it would live on in all later tests."""
    yield
    if "PySide6.QtWidgets" not in sys.modules:
        return
    from PySide6.QtWidgets import QApplication

    left = [widget for widget in QApplication.topLevelWidgets() if widget.isVisible()]
    for widget in left:
        widget.close()
    assert not left, f"{item.nodeid} left windows open: {left}"
