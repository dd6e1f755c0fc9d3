import json
import os
from dataclasses import fields, replace

import numpy as np
import pytest

from core import generations
from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for
from core.errors import ArrayShapeError
from core.eye_reader import PATCH_PIXELS, EyeReader
from core.fern_regressor import FernRegressor
from core.generations import (
    ProfileDamagedError,
    ProfileMissingError,
    ProfileNewerError,
    ProfileUnwritableError,
    check_target,
    read_generation,
    write_generation,
)
from core.plain_json import json_text
from core.records import Landmarks2D, ModelFit, SetupShapes, UserBlendshapes
from core.store import Profile, load, load_pictures, save

N, L, Q, V, B = 3, 75, 77, 11, len(EXPRESSION_NAMES)
T, P, K, F, D = 2, 9, 4, 2, 3


def make_regressor(rng):
    numbers = {
        "weights": (T, P, 3), "offsets_mm": (T, P, 3), "softening": (), "thresholds": (T, K, F),
        "leaves": (T, K, 2**F, D), "basis_mm": (T, D, Q, 3), "shapes_mm": (N, Q, 3),
        "translations_mm": (6, 3), "mean_mm": (Q, 3), "size_gauge": (Q, 3),
        "check_weights": (7, 3), "check_mean": (7,), "check_basis": (2, 7), "check_level": (),
        "check_softening": (),
    }  # fmt: skip
    indices = {
        "corners": (T, P, 3), "members": (T, 2, 4), "cell": (T, P), "pairs": (T, K, F, 2),
        "check_corners": (7, 3), "check_members": (2, 4), "check_cell": (7,),
    }  # fmt: skip
    arrays = {name: 50 * rng.random(shape) for name, shape in numbers.items()}
    return FernRegressor.from_arrays(
        arrays | {name: rng.integers(0, 2, shape) for name, shape in indices.items()}
    )


def make_profile(rng, name="pose_yaw"):
    def landmarks():
        return Landmarks2D(
            rng.random((L, 2)), rng.random(L) > 0.5, rng.random(L), rng.random((2, 2)), [0.0, 1.0]
        )

    return Profile(
        names=tuple(f"{name}{n}" for n in range(N)),
        standard=np.where(np.arange(N)[:, None] == 1, np.nan, rng.random((N, B))),
        landmarks=tuple(landmarks() for _ in range(N)),
        camera=camera_for((640, 480), 612.5),
        fit=ModelFit(
            rng.random(5), rng.random((N, B)), rng.random((N, 4)), rng.random((N, 3)),
            rng.integers(0, V, (N, L)), rng.random(N), rng.random((60, 3)),
        ),
        user=UserBlendshapes(rng.random(5), rng.random((V, 3)), rng.random((B, V, 3))),
        shapes=SetupShapes(
            rng.random((N, Q, 3)), rng.random((N, 4)), rng.random((N, 3)), rng.random((N, B)),
            rng.random(N),
        ),
        regressor=make_regressor(rng),
        report={"held_out": {"rmse_px": np.float32(0.75), "worst": np.nan, "frames": [1, 2]}},
        eyes=EyeReader(
            rng.random((2, 4, PATCH_PIXELS)), rng.random((2, 5 + PATCH_PIXELS, 2)), 0.06
        ),
    )  # fmt: skip


PICTURES = {f"pose_yaw{n}.png": bytes([n]) * 100 for n in range(N)}


def assert_same(found, wanted):
    for entry in fields(wanted):
        a, b = getattr(found, entry.name), getattr(wanted, entry.name)
        if isinstance(b, np.ndarray):
            np.testing.assert_array_equal(a, b, err_msg=entry.name)
            assert a.dtype == b.dtype
        else:
            assert a == b, entry.name


def assert_same_profile(found, wanted):
    for name in ("camera", "fit", "user", "shapes", "regressor", "eyes"):
        assert_same(getattr(found, name), getattr(wanted, name))
    for a, b in zip(found.landmarks, wanted.landmarks, strict=True):
        assert_same(a, b)
    np.testing.assert_array_equal(found.standard, wanted.standard)
    assert found.names == wanted.names


def test_what_is_saved_is_loaded_bit_for_bit(tmp_path, rng):
    profile = make_profile(rng)
    save(tmp_path / "anna", profile, PICTURES)
    found = load(tmp_path / "anna")
    assert_same_profile(found, profile)
    assert found.report == {
        "held_out": {"rmse_px": pytest.approx(0.75), "worst": None, "frames": [1, 2]}
    }
    assert load_pictures(tmp_path / "anna") == PICTURES


def test_saving_again_replaces_everything_and_leaves_one_generation(tmp_path, rng):
    save(tmp_path, make_profile(rng), PICTURES)
    second = make_profile(rng, "other")
    save(tmp_path, second, {"other0.png": b"new"})
    assert_same_profile(load(tmp_path), second)
    assert load_pictures(tmp_path) == {"other0.png": b"new"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["data-0002", "profile.json"]


def test_a_moved_profile_loads(tmp_path, rng):
    profile = make_profile(rng)
    save(tmp_path / "here", profile, PICTURES)
    os.rename(tmp_path / "here", tmp_path / "there")
    assert_same_profile(load(tmp_path / "there"), profile)


@pytest.mark.parametrize("calls_before", range(6))
@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_whatever_stops_the_writing_the_last_state_loads(
    tmp_path, rng, monkeypatch, calls_before, error
):
    profile = make_profile(rng)
    save(tmp_path, profile, PICTURES)
    before = sorted(path.name for path in tmp_path.iterdir())
    calls, real = iter(range(100)), os.fsync

    def failing(handle):
        if next(calls) == calls_before:
            raise error
        real(handle)

    monkeypatch.setattr(os, "fsync", failing)
    expected = ProfileUnwritableError if isinstance(error, OSError) else KeyboardInterrupt
    with pytest.raises(expected):
        save(tmp_path, make_profile(rng, "other"), PICTURES)
    monkeypatch.undo()
    assert_same_profile(load(tmp_path), profile)
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_an_interrupt_right_after_the_replacement_keeps_the_new_state(tmp_path, rng, monkeypatch):
    save(tmp_path, make_profile(rng), PICTURES)
    second, real = make_profile(rng, "other"), os.replace

    def interrupted(source, target):
        real(source, target)
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save(tmp_path, second, PICTURES)
    assert_same_profile(load(tmp_path), second)


def test_the_unfinished_generation_of_a_killed_program_is_ignored_and_then_removed(tmp_path, rng):
    profile = make_profile(rng)
    save(tmp_path, profile, PICTURES)
    (tmp_path / "data-0007").mkdir()
    (tmp_path / "data-0007" / "setup.npz").write_bytes(b"half a fi")
    assert_same_profile(load(tmp_path), profile)
    save(tmp_path, profile, PICTURES)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["data-0008", "profile.json"]


def test_no_profile_says_how_to_make_one(tmp_path):
    with pytest.raises(ProfileMissingError, match="facepuppet setup on the command line"):
        load(tmp_path / "nobody")


def test_newer_schema_names_both_versions_and_is_not_overwritten(tmp_path, rng):
    save(tmp_path, make_profile(rng), PICTURES)
    header = tmp_path / "profile.json"
    newer = json.loads(header.read_text()) | {"schema": 7}
    header.write_text(json.dumps(newer))
    for attempt in (load, load_pictures, lambda folder: save(folder, make_profile(rng), PICTURES)):
        with pytest.raises(ProfileNewerError, match=r"version 7, this program knows .* up to 1"):
            attempt(tmp_path)
    assert json.loads(header.read_text()) == newer


@pytest.mark.parametrize(
    "name", ["setup.npz", "user.npz", "regressor.npz", "eyes.npz", "report.json"]
)
def test_every_missing_or_changed_file_is_named(tmp_path, rng, name):
    save(tmp_path, make_profile(rng), PICTURES)
    path = tmp_path / "data-0001" / name
    content = path.read_bytes()
    for damaged, found in (
        (content[: len(content) // 2], "bytes long, expected"),
        (bytes([content[0] ^ 1]) + content[1:], "changed since it was written"),
    ):
        path.write_bytes(damaged)
        with pytest.raises(ProfileDamagedError, match=found) as caught:
            load(tmp_path)
        assert name in str(caught.value)
    path.unlink()
    with pytest.raises(ProfileDamagedError, match="no such file"):
        load(tmp_path)


@pytest.mark.parametrize("text", ["", "{", "[]", '{"format": "x"}', '{"schema": 1}'])
def test_a_damaged_header_is_reported_and_not_overwritten(tmp_path, rng, text):
    (tmp_path / "profile.json").write_text(text)
    with pytest.raises(ProfileDamagedError, match=r"profile\.json"):
        load(tmp_path)
    with pytest.raises(ProfileDamagedError):
        save(tmp_path, make_profile(rng), PICTURES)
    assert (tmp_path / "profile.json").read_text() == text


def test_a_header_without_its_parts_is_damaged(tmp_path):
    header = {"format": generations.FORMAT, "schema": 1, "data": "data-0001"}
    (tmp_path / "profile.json").write_text(json.dumps(header))
    with pytest.raises(ProfileDamagedError, match="incomplete"):
        read_generation(tmp_path)


def test_arrays_that_do_not_fit_each_other_are_damage_too(tmp_path):
    buffer = {"setup.npz": b"no zip", "user.npz": b"", "regressor.npz": b"", "report.json": b"{}"}
    header = {"names": ["a"], "focal_px": 1.0, "center_px": [0, 0], "size_px": [4, 4]}
    write_generation(tmp_path, header, buffer)
    with pytest.raises(ProfileDamagedError, match="inconsistent"):
        load(tmp_path)


def test_a_pickle_is_never_opened(tmp_path, rng):
    path = tmp_path / "evil.npz"
    np.savez(path, names=np.array([{"a": 1}], dtype=object))
    header = {"names": ["a"], "focal_px": 1.0, "center_px": [0, 0], "size_px": [4, 4]}
    write_generation(tmp_path / "p", header, {"setup.npz": path.read_bytes()})
    with pytest.raises(ProfileDamagedError, match="allow_pickle=False"):
        load(tmp_path / "p")


def test_a_folder_of_other_things_is_refused(tmp_path, rng):
    (tmp_path / "holiday.jpg").write_bytes(b"dear")
    with pytest.raises(ProfileUnwritableError, match="holds other files and no profile"):
        save(tmp_path, make_profile(rng), PICTURES)
    assert [path.name for path in tmp_path.iterdir()] == ["holiday.jpg"]


def test_a_place_that_cannot_be_written_is_found_before_the_work(tmp_path):
    (tmp_path / "file").write_text("a file, not a folder")
    with pytest.raises(ProfileUnwritableError, match="what was there is unchanged"):
        check_target(tmp_path / "file" / "profile")


def test_pictures_landmarks_and_coefficients_must_be_equally_many(rng):
    profile = make_profile(rng)
    with pytest.raises(ArrayShapeError, match="one number of images"):
        replace(profile, names=("one",))


def test_report_text_has_no_nan_and_keeps_letters():
    text = json_text({"größe": np.float64("inf"), "n": np.int64(3), "a": np.array([1.5, np.nan])})
    assert json.loads(text) == {"größe": None, "n": 3, "a": [1.5, None]}
    assert "größe" in text
