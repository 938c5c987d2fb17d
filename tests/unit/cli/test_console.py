"""Writing to the terminal."""

from __future__ import annotations

import io

import pytest

from tactsim.cli import console


class Gone(io.StringIO):
    """A stream whose reader is gone."""

    def write(self, text: str) -> int:
        raise BrokenPipeError


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_reader_that_is_gone_is_no_error(stream: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"sys.{stream}", Gone())
    console.out("text")
    console.note("text")
    console.flush()


def test_text_that_the_terminal_cannot_show_is_escaped(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr("sys.stdout", stream)
    console.out("800 µm \udcff")
    assert stream.buffer.getvalue() == b"800 \\xb5m \\udcff\n"  # type: ignore[attr-defined]


def test_errors_go_to_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    console.error("no")
    console.out("yes")
    assert capsys.readouterr() == ("yes\n", "error: no\n")
    assert not console.notes_are_watched()
