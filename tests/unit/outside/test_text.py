"""Foreign text on a terminal."""

from __future__ import annotations

import pytest

from tactsim.outside.text import aligned, counted, first_names, one_line, printable


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Ärger mit 3 µm · 测试 ™", "Ärger mit 3 µm · 测试 ™"),
        ("ok\x1b[31m\nconverged", "ok\\x1b[31m\\nconverged"),
        ("a\rb\x07\x9b2J", "a\\rb\\x07\\x9b2J"),
        ("left\u202eright\u2028next\u200b", "left\\u202eright\\u2028next\\u200b"),
        ("half \ud800", "half \\ud800"),
        ("tab\t", "tab\\t"),
    ],
)
def test_control_characters_are_spelled_out(text: str, shown: str) -> None:
    assert one_line(text) == shown


def test_long_text_is_cut_in_the_middle() -> None:
    assert one_line("a" * 300 + "b" * 300, 9) == "aaa...bbb"
    assert len(one_line("\x1b" * 10_000, 100)) == 100
    assert one_line(ValueError("x")) == "x"


def test_lines_and_tabs_of_a_report_stay() -> None:
    assert printable("a\n\tb") == "a\n\tb"
    assert printable("a\nb\x1b]0;x\x07\r") == "a\nb\\x1b]0;x\\x07\\r"


def test_columns_are_as_wide_as_their_widest_cell() -> None:
    table = [["", "soft", "hard"], ["force", "1 N", "-1.2346e-12"]]
    assert aligned(table) == ["       soft         hard", "force   1 N  -1.2346e-12"]
    assert aligned(table, left=3, least=[7, 6], indent="  ") == ["           soft    hard", "  force    1 N     -1.2346e-12"]
    assert aligned([]) == []


def test_of_many_names_the_first_are_named_and_the_others_counted():
    assert first_names(["a", "b"], 2) == "a, b"
    assert first_names([3, 12, 40], 2) == "3, 12 and 1 more"


def test_one_is_not_counted_in_the_plural() -> None:
    assert [counted(number, "sample") for number in (0, 1, 2)] == ["0 samples", "1 sample", "2 samples"]
    assert [counted(number, "process", "processes") for number in (1, 2)] == ["1 process", "2 processes"]
