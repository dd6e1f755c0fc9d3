"""Runs facepuppet, or its tests, from a fresh checkout.

python3 run.py [arguments]     run the program (same arguments as `facepuppet`)
python3 run.py test            pass all checks and tests
python3 run.py test ARGUMENTS  run pytest alone, with these arguments

The first call makes the folder .venv beside this file and installs what the program needs into
it. Nothing is set for the whole machine, except that on Debian and Ubuntu missing system
libraries are installed when that needs no password.
"""

from __future__ import annotations  # so that an old Python reaches check_python

import ctypes
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent
ENVIRONMENT = ROOT / ".venv"
BINARIES = ENVIRONMENT / ("Scripts" if os.name == "nt" else "bin")
OLDEST, NEWEST = (3, 11), (3, 14)

# Library that must load -> Debian package that holds it.
OFFSCREEN_LIBRARIES = {
    "libgthread-2.0.so.0": "libglib2.0-0",
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libdbus-1.so.3": "libdbus-1-3",
    "libfontconfig.so.1": "libfontconfig1",
    "libxkbcommon.so.0": "libxkbcommon0",
}
WINDOW_LIBRARIES = {
    "libxkbcommon-x11.so.0": "libxkbcommon-x11-0",
    "libxcb-cursor.so.0": "libxcb-cursor0",
    "libxcb-icccm.so.4": "libxcb-icccm4",
    "libxcb-keysyms.so.1": "libxcb-keysyms1",
    "libxcb-shape.so.0": "libxcb-shape0",
    "libwayland-cursor.so.0": "libwayland-cursor0",
    "libwayland-egl.so.1": "libwayland-egl1",
}


def main(arguments: list[str]) -> int:
    """Prepare the environment, then run the program or the tests; return the exit code."""
    check_python()
    install_debian_packages(missing_packages())
    testing = arguments[:1] == ["test"]
    prepare_environment(with_tests=testing)
    if not testing:
        return call([tool("facepuppet"), *arguments])
    return run_pytest(arguments[1:]) if len(arguments) > 1 else run_checks()


def check_python() -> None:
    """Stop unless this Python can run facepuppet."""
    if not OLDEST <= sys.version_info[:2] <= NEWEST:
        found = ".".join(map(str, sys.version_info[:3]))
        stop(
            f"found Python {found} ({sys.executable}); facepuppet needs Python "
            f"{OLDEST[0]}.{OLDEST[1]} to {NEWEST[0]}.{NEWEST[1]}. Start this script with one of "
            f"them, for example: python3.12 run.py"
        )


def missing_packages() -> list[str]:
    """Return the Debian packages that facepuppet needs and this Linux machine lacks."""
    if not sys.platform.startswith("linux"):
        return []
    libraries = dict(OFFSCREEN_LIBRARIES)
    if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        libraries.update(WINDOW_LIBRARIES)
    packages = [package for library, package in libraries.items() if not loads(library)]
    # Debian takes ensurepip, without which no environment can be made, out of its Python.
    if not BINARIES.exists() and importlib.util.find_spec("ensurepip") is None:
        packages.append("python3-venv")
    return packages


def loads(library: str) -> bool:
    """Return whether the dynamic linker finds the library."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def install_debian_packages(packages: list[str]) -> None:
    """Install the packages if that needs no password, else stop and say how to."""
    if not packages:
        return
    command = ["apt-get", "install", "-y", "--no-install-recommends", *packages]
    by_hand = f"sudo apt-get update && sudo {' '.join(command)}"
    if shutil.which("apt-get") is None:
        stop(
            f"this machine lacks the system libraries of the Debian packages {' '.join(packages)}; "
            "install your distribution's packages that hold them, then start again"
        )
    prefix = root_prefix()
    if prefix is None:
        stop(f"this machine lacks system libraries. Run this, then start again:\n  {by_hand}")
    say(f"Installing system libraries: {' '.join(packages)}")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    subprocess.call([*prefix, "apt-get", "update", "-qq"], env=environment)
    if subprocess.call([*prefix, *command, "-qq"], env=environment) != 0:
        stop(f"apt-get failed (see above). When its trouble is mended, run:\n  {by_hand}")


def root_prefix() -> list[str] | None:
    """Return what to put before a command to run it as root, None if that needs a password."""
    if os.geteuid() == 0:
        return []
    asked = ["sudo", "-n", "true"]
    if shutil.which("sudo") and subprocess.call(asked, stderr=subprocess.DEVNULL) == 0:
        return ["sudo", "-n"]
    return None


def prepare_environment(with_tests: bool) -> None:
    """Make .venv and install facepuppet into it, unless both are up to date."""
    record = ENVIRONMENT / "installed.json"
    made_for = {"folder": str(ROOT), "python": list(sys.version_info[:2])}
    wanted = hashlib.sha256((ROOT / "pyproject.toml").read_bytes()).hexdigest()
    found = read_state(record)
    current = found.get("made_for") == made_for and Path(tool("python")).exists()
    if current and found.get("project") == wanted and (found.get("tests") or not with_tests):
        return
    if not current:
        make_environment()
    record.unlink(missing_ok=True)
    with_tests = with_tests or bool(current and found.get("tests"))
    say("Installing facepuppet and what it needs into it; this happens once and takes minutes")
    target = f"{ROOT}[test]" if with_tests else str(ROOT)
    pip = [tool("python"), "-m", "pip", "install", "--disable-pip-version-check", "-e", target]
    if call(pip, cwd=ROOT) != 0:
        stop("pip could not install the packages (see above); check the network and start again")
    state = {"made_for": made_for, "project": wanted, "tests": with_tests}
    record.write_text(json.dumps(state), encoding="utf-8")


def make_environment() -> None:
    """Make an empty .venv with pip in it."""
    say(f"Making the environment {ENVIRONMENT}")
    if call([sys.executable, "-m", "venv", "--clear", str(ENVIRONMENT)]) != 0:
        shutil.rmtree(ENVIRONMENT, ignore_errors=True)
        stop(
            f"{sys.executable} cannot make an environment (see above); install its venv module, "
            "on Debian and Ubuntu with: sudo apt-get install python3-venv"
        )


def read_state(record: Path) -> dict:
    """Return what an earlier call noted about the environment, {} if nothing readable."""
    try:
        return json.loads(record.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def run_checks() -> int:
    """Run the checkers, then every test; return 0 if all are content."""
    checks = {
        "ruff check": [tool("ruff"), "check", "."],
        "ruff format": [tool("ruff"), "format", "--check", "."],
        "import-linter": [tool("lint-imports")],
        "mypy": [tool("mypy")],
        "tests without numba's compiler": [
            tool("python"),
            "-m",
            "pytest",
            "-q",
            "-m",
            "nojit",
            "tests/core",
        ],
    }
    failed = []
    for name, command in checks.items():
        say(f"== {name}")
        extra = {"NUMBA_DISABLE_JIT": "1"} if "numba" in name else {}
        if call(command, cwd=ROOT, **extra) != 0:
            failed.append(name)
    say("== tests")
    code = run_pytest(side_by_side())
    if failed:
        say(f"not content: {', '.join(failed)} (see above)")
    return code or int(bool(failed))


def side_by_side() -> list[str]:
    """Return the options that let several processes share the test files."""
    workers = min(os.cpu_count() or 1, 4)
    # Times taken side by side say nothing, and the benchmarks' plugin would complain.
    return ["-p", "no:benchmark", "-n", str(workers), "--dist", "loadfile"]


def run_pytest(arguments: list[str]) -> int:
    """Run pytest in the checkout; return its exit code."""
    return call([tool("python"), "-m", "pytest", *arguments], cwd=ROOT)


def tool(name: str) -> str:
    """Return the path of a program of the environment."""
    return str(BINARIES / (name + (".exe" if os.name == "nt" else "")))


def call(command: list[str], cwd: Path | None = None, **variables: str) -> int:
    """Run a command to its end and return its exit code."""
    try:
        return subprocess.call(command, cwd=cwd, env={**os.environ, **variables})
    except KeyboardInterrupt:
        return 130


def say(text: str) -> None:
    """Tell the user, in order with what the commands print."""
    print(text, file=sys.stderr, flush=True)


def stop(text: str) -> None:
    """End with a message."""
    say(f"run.py: {text}")
    raise SystemExit(2)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
