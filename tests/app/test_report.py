"""Facts about the report of a training, and about what it says of the one before."""

import re

from app.picture_names import opposite, title_of
from app.report import report_html, report_page
from app.report_change import change_rows
from app.report_words import NAMES, verdict_words, weak_words, without_side
from core.arkit import EXPRESSION_NAMES

UNDER = {"3": 0.98, "4.5": 1.0, "6": 1.0}


def part(median, tries=5, turn=1.5):
    return {
        "tries": tries, "median_rmse_px": median, "share_under_px": UNDER, "mean_turn_deg": turn,
    }  # fmt: skip


def figures(mean, **more):
    return {
        "pictures": 12, "tries": 60, "mean_rmse_px": mean, "median_rmse_px": mean,
        "mean_percent_of_eye_distance": 0.47, "share_under_px": UNDER,
        "mean_turn_deg": {"yaw": 0.4, "pitch": 0.5, "roll": 0.2}, **more,
    }  # fmt: skip


HELD = figures(
    0.66,
    by_yaw={"0-15 deg": part(0.63, 40), "15-40 deg": part(0.81, 20)},
    by_expression={"smile": part(0.7), "mouth_stretch": part(1.9)},
    by_picture=[{"name": "a", "rmse_px": 0.5}, {"name": "b", "rmse_px": 0.7}],
    worst_pictures=[{"picture": 57, "mean_rmse_px": 0.85}],
)
REPORT = {
    "pictures": 60, "left_out": ["smile_yaw+0"], "guessed": ["pose_yaw-90"], "focal_px": 612.0,
    "focal_source": "found", "picture_names": [f"p{n}" for n in range(60)], "held_out": HELD,
    "free": {
        "at_first": figures(4.4),
        "later": figures(2.2, by_yaw={"0-15 deg": part(2.1)}, by_expression={"smile": part(3.3)}),
    },
    "weak_expressions": [
        {"name": "cheekPuff", "sides": "both", "strength": 0.0,
         "reasons": [{"kind": "small", "px": 1.04}]},
        {"name": "jawLeft", "sides": "", "strength": 0.4,
         "reasons": [{"kind": "missing", "faces": ["jaw_left"], "pictures": []}]},
    ],
}  # fmt: skip


def rows_of(html):
    return [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", html)]


def test_the_report_says_how_good_it_is_beside_the_paper_and_without_training():
    html = report_html("me & <you>", REPORT)
    assert "me &amp; &lt;you&gt;" in html
    for text in (
        "60 pictures",
        "0.66 px",
        "left out, no face was found: smile<",
        "turn 90° right",
        "href='p57'",
    ):
        assert text in html
    rows = {row[0]: row[1:] for row in rows_of(html) if row}
    assert rows["under 3 px"] == ["98.0 %", "98.0 %", "98.0 %", "73.3 %"]
    assert rows["average error"][:3] == ["0.66 px", "2.20 px", "4.40 px"]
    assert rows["of the eye distance"][0] == "0.47 %"
    assert rows["head off by"][0] == "0.4° yaw, 0.5° pitch, 0.2° roll"
    assert rows["0-15°"] == ["0.63 px", "1.50°", "2.10 px", "40"]


def test_one_sentence_at_the_top_says_how_good_it_is():
    html = report_html("me", REPORT)
    assert html.index("The training went well: in 12 pictures") < html.index("60 pictures")
    assert "points come from the very picture" in html.split("</p>")[0]
    assert "training-free" not in report_html("me", REPORT | {"free": {}}).split("</p>")[0]


def test_the_sentence_goes_with_the_figures():
    few = verdict_words(HELD | {"pictures": 3, "mean_percent_of_eye_distance": 3.4}, False)
    assert "fairly well" in few and "rough figure" in few
    assert "not exact" in verdict_words(HELD | {"mean_percent_of_eye_distance": 9.0}, False)


def test_expressions_stand_in_the_order_of_their_errors_beside_the_training_free_mode():
    rows = rows_of(report_html("me", REPORT))
    names = [row[0] for row in rows if row and row[0] in ("smile", "mouth stretch")]
    assert names == ["mouth stretch", "smile"]
    smile = next(row for row in rows if row and row[0] == "smile")
    assert smile[1] == "0.70 px" and smile[3] == "3.30 px"


def test_a_file_of_its_own_has_no_links_to_pictures():
    html = report_page("me", report_html("me", REPORT, links=False))
    assert html.startswith("<!doctype html>") and "href" not in html and "p57" in html


def test_a_report_without_a_test_is_shown_as_far_as_it_goes():
    html = report_html("me", {"pictures": 12})
    assert "12 pictures" in html and "table" not in html


def test_a_report_of_an_older_program_is_shown():
    held = {key: value for key, value in HELD.items() if not key.startswith("by_")}
    html = report_html("me", {"pictures": 12, "held_out": held})
    assert "0.66 px" in html and "without" not in html


def test_the_reasons_of_weak_expressions_are_words():
    html = report_html("me", REPORT)
    assert "<b>Puffed cheeks</b>: it moves no point of your face further than 1.0 px" in html
    assert "take that of “jaw left” to make it yours" in html


def test_every_kind_of_reason_has_words():
    kinds = [
        {"kind": "like", "other": "mouthSmileRight", "likeness": 0.9}, {"kind": "never asked"},
        {"kind": "unused", "faces": ["grin"], "pictures": ["grin_yaw+0", "grin_yaw-30"]},
        {"kind": "unshown", "share": 0.44, "faces": ["anger", "disgust"]},
    ]  # fmt: skip
    what, why = weak_words({"name": "browDown", "sides": "left", "reasons": kinds})
    assert what == "Lowered eyebrows on your left side"
    like, never, unused, unshown, _ = why.split("; ")
    assert "smiling" in like and "average face" in never
    assert "grin and grin (30° right)" in unused
    assert "“anger” and “disgust”" in unshown and "about 4 tenths" in unshown


def test_every_expression_has_a_name_for_people():
    assert {without_side(name) for name in EXPRESSION_NAMES} == set(NAMES)


def test_a_first_training_changes_nothing():
    assert change_rows(REPORT) == [] and "What this training changed" not in report_html(
        "m", REPORT
    )


def test_the_report_shows_what_a_training_changed():
    old_held = figures(
        1.00, by_yaw={"0-15 deg": part(0.9)}, share_under_px={"3": 0.9, "4.5": 1.0, "6": 1.0},
        by_picture=[{"name": "a", "rmse_px": 0.9}, {"name": "c", "rmse_px": 9.0}],
    )  # fmt: skip
    previous = {"pictures": 52, "focal_px": 600.0, "held_out": old_held}
    rows = {row[0]: row[1:] for row in change_rows(REPORT | {"previous": previous})}
    assert rows["pictures"] == ("52", "60", "+8")
    assert rows["focal length"] == ("600 px", "612 px", "+12 px")
    assert rows["average error"] == ("1.00 px", "0.66 px", "-0.34 px")
    assert rows["the same on the 1 test pictures of both"] == ("0.90 px", "0.50 px", "-0.40 px")
    assert rows["under 3 px"] == ("90.0 %", "98.0 %", "+8.0 %")
    assert rows["under 6 px"] == ("100.0 %", "100.0 %", "the same")
    assert rows["median error, head turned 0-15°"] == ("0.90 px", "0.63 px", "-0.27 px")
    assert rows["median error, head turned 15-40°"] == ("–", "0.81 px", "")
    assert "What this training changed" in report_html("me", REPORT | {"previous": previous})


def test_names_of_pictures_are_read_by_people():
    assert title_of("smile_yaw-30") == "smile (30° right)"
    assert title_of("smile_yaw+0") == "smile"
    assert title_of("pose_pitch+15") == "tilt 15° up"
    assert title_of("pose_roll+15") == "lean 15° left"
    assert title_of("glasses~pose_yaw+0") == "glasses: straight ahead"
    assert title_of("hand~right-cheek~pose_yaw+0") == "hand, right cheek: straight ahead"
    assert title_of("live-0001") == "live-0001"


def test_the_opposite_of_a_picture_of_a_set_is_in_the_set():
    assert opposite("glasses~smile_yaw-30") == "glasses~smile_yaw+30"
    assert opposite("hand~right-cheek~pose_yaw+0") == "hand~left-cheek~pose_yaw+0"
    assert opposite("squeeze_left_eye_yaw+0") == "squeeze_right_eye_yaw+0"
    assert opposite("smile_yaw+0") == "" and opposite("live-0001") == ""
