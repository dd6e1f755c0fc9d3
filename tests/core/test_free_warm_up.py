"""Facts about getting ready for the first live picture."""

import importlib
import pkgutil

from numba.core.registry import CPUDispatcher

import core.kernels
from core.free_live import FreeSettings
from core.free_warm_up import warm_up
from tests.core.test_free_live import Stage, wandering


def compiled():
    """How often each kernel was compiled in this process."""
    found = {}
    for module in pkgutil.iter_modules(core.kernels.__path__, "core.kernels."):
        for name, kernel in vars(importlib.import_module(module.name)).items():
            if isinstance(kernel, CPUDispatcher):
                found[name] = len(kernel.signatures)
    return found


def test_nothing_is_left_to_be_compiled_when_a_face_comes():
    stage = Stage(settings=FreeSettings(), identity_seed=4)
    warm_up(stage.user.model)
    before = compiled()
    assert any(before.values())
    wandering(stage, 60)
    stage.face = None
    stage.film()
    assert compiled() == before
