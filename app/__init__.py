"""Everything with a device, a window, a wire or a command line."""

import os
import sys
import tempfile
from pathlib import Path


def _cache_folder() -> Path:
    """Return the folder of this user for what can be made again."""
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "facepuppet" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "facepuppet"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "facepuppet"


def _numba_cache() -> Path:
    """Return a folder for compiled kernels that can be written, also without a home."""
    folder = _cache_folder() / "numba"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return Path(tempfile.gettempdir()) / "facepuppet-numba"
    return folder


# These are read once, when numba, OpenBLAS and OpenCV are first imported; app comes before them.
# The folder of an installed package may be read-only, so compiled kernels go to the user's cache.
os.environ.setdefault("NUMBA_CACHE_DIR", str(_numba_cache()))
# Our products are small: threads in OpenBLAS cost ten times what they save.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# A file that cannot be read is reported by us, once and in words for the user.
os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
