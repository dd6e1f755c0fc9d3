"""Reports as JSON text that every reader accepts."""

import json
import math
from collections.abc import Mapping

import numpy as np


def json_text(value: object) -> str:
    """Return a report as indented JSON.

    Numbers of numpy become plain ones. JSON has no NaN and no infinity: both become null, which
    says what they mean here, that there is nothing to tell.
    """
    return json.dumps(_plain(value), indent=2, ensure_ascii=False, allow_nan=False)


def _plain(value: object) -> object:
    if isinstance(value, Mapping):
        return {str(name): _plain(entry) for name, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
