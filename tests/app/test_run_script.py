"""run.py, without installing anything."""

import sys

import pytest

import run


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A checkout in which every command is noted instead of run, and succeeds."""
    calls = []

    def call(command, **_):
        calls.append([str(word).removeprefix(str(tmp_path)) for word in command])
        if "venv" in command:
            for name in ("python", "python.exe"):
                path = tmp_path / ".venv" / ("Scripts" if "exe" in name else "bin") / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.touch()
        return 0

    (tmp_path / "pyproject.toml").write_text("[project]")
    monkeypatch.setattr(run, "ROOT", tmp_path)
    monkeypatch.setattr(run, "ENVIRONMENT", tmp_path / ".venv")
    monkeypatch.setattr(run, "BINARIES", tmp_path / ".venv" / run.BINARIES.name)
    monkeypatch.setattr(run, "call", call)
    monkeypatch.setattr(run, "missing_packages", list)
    return tmp_path, calls


def installs(calls):
    return [command[-1] for command in calls if "pip" in command]


def test_a_python_outside_the_range_is_refused_with_the_range(monkeypatch, capsys):
    for version in ((3, 10, 2), (3, 99, 0)):
        monkeypatch.setattr(sys, "version_info", version)
        with pytest.raises(SystemExit) as ended:
            run.check_python()
        assert ended.value.code == 2
        said = capsys.readouterr().err
        assert ".".join(map(str, version)) in said and "3.11 to 3.14" in said


def test_the_environment_is_made_once(checkout):
    _, calls = checkout
    assert run.main(["--help"]) == 0
    first = list(calls)
    assert run.main(["--help"]) == 0
    assert [command[1:3] for command in first[:2]] == [["-m", "venv"], ["-m", "pip"]]
    assert calls[len(first) :] == [first[-1]]
    assert first[-1][0].endswith("facepuppet") and first[-1][1:] == ["--help"]


def test_the_tests_are_installed_when_first_asked_for_and_then_stay(checkout):
    root, calls = checkout
    run.main([])
    run.main(["test", "-k", "store"])
    run.main(["test", "-k", "store"])
    assert installs(calls) == ["", "[test]"]
    (root / "pyproject.toml").write_text("[project] # more")
    run.main([])
    assert installs(calls) == ["", "[test]", "[test]"]


def test_a_moved_checkout_gets_a_new_environment(checkout, monkeypatch, tmp_path_factory):
    _, calls = checkout
    run.main([])
    moved = tmp_path_factory.mktemp("moved")
    (moved / "pyproject.toml").write_text("[project]")
    monkeypatch.setattr(run, "ROOT", moved)
    run.main([])
    assert sum("venv" in command for command in calls) == 2


def test_arguments_after_test_go_to_pytest_alone(checkout):
    _, calls = checkout
    run.main(["test", "tests/core", "-k", "store"])
    assert calls[-1][1:] == ["-m", "pytest", "tests/core", "-k", "store"]
    assert not any("ruff" in word for command in calls for word in command)


def test_all_checks_run_before_the_tests_and_one_failure_is_enough(checkout, monkeypatch, capsys):
    _, calls = checkout
    noted = run.call
    monkeypatch.setattr(
        run, "call", lambda command, **rest: noted(command, **rest) or int("mypy" in command[0])
    )
    assert run.main(["test"]) == 1
    names = [command[0].rsplit("/")[-1].removesuffix(".exe") for command in calls[2:]]
    assert names == ["ruff", "ruff", "lint-imports", "mypy", "python", "python"]
    assert calls[-1][1:3] == ["-m", "pytest"]
    assert calls[-1][-2:] == ["--dist", "loadfile"]
    assert capsys.readouterr().err.endswith("not content: mypy (see above)\n")


def test_missing_libraries_are_named_by_their_debian_packages(monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(run, "loads", lambda library: "EGL" not in library)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert run.missing_packages() == ["libegl1"]
    monkeypatch.setattr(run, "loads", lambda library: "xcb-cursor" not in library)
    assert run.missing_packages() == []
    monkeypatch.setenv("DISPLAY", ":0")
    assert run.missing_packages() == ["libxcb-cursor0"]


def test_without_root_the_line_to_run_is_printed(monkeypatch, capsys):
    monkeypatch.setattr(run.shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(run, "root_prefix", lambda: None)
    with pytest.raises(SystemExit):
        run.install_debian_packages(["libegl1"])
    said = capsys.readouterr().err
    assert "sudo apt-get update && sudo apt-get install -y --no-install-recommends libegl1" in said


def test_another_linux_is_told_which_packages_hold_the_libraries(monkeypatch, capsys):
    monkeypatch.setattr(run.shutil, "which", lambda name: None)
    with pytest.raises(SystemExit):
        run.install_debian_packages(["libegl1"])
    assert "your distribution's packages" in capsys.readouterr().err


def test_an_unreadable_note_of_an_earlier_call_is_ignored(tmp_path):
    (tmp_path / "installed.json").write_text("{ half")
    assert run.read_state(tmp_path / "installed.json") == {}
    assert run.read_state(tmp_path / "missing.json") == {}
