"""One page for each command, from the parsers that read its options."""

from __future__ import annotations

import argparse
import re
from inspect import cleandoc

from markdown_parts import of_docstring, page, table, toctree

from tactsim.cli import entry
from tactsim.cli.entry import COMMANDS, EXIT_CODES


def command_pages() -> dict[str, str]:
    """The page of each command, and the page that lists them."""
    parser = entry._parser()
    parsers = next(action for action in parser._actions if isinstance(action, argparse._SubParsersAction)).choices
    rows = [(f"[`tactsim {command.NAME}`]({command.NAME}.md)", command.SUMMARY) for command in COMMANDS]
    index = page(
        ["# Commands", "", "Every command and option of `tactsim`, as `--help` prints them.", ""],
        table(("command", "does"), rows),
        toctree([command.NAME for command in COMMANDS])[:1],
        [":hidden:", "", *(command.NAME for command in COMMANDS), "```", ""],
        ["## Exit codes", "", "```text", *EXIT_CODES.strip().splitlines()[1:], "```"],
    )
    return {"commands/index.md": index} | {
        f"commands/{command.NAME}.md": _command_page(command.NAME, parsers[command.NAME], command.EXAMPLES)
        for command in COMMANDS
    }


def _command_page(name: str, parser: argparse.ArgumentParser, examples: str) -> str:
    usage = parser.format_usage().removeprefix("usage: ").strip()
    lines = [f"# tactsim {name}", "", *_prose(parser.description or ""), "```text", usage, "```", "", *_options(parser, "##")]
    for action in parser._actions:
        for part, inner in (action.choices or {}).items() if isinstance(action, argparse._SubParsersAction) else ():
            lines += [f"## {part}", "", *_prose(inner.description or ""), *_options(inner, "###")]
    lines += ["## Examples", "", "```text", *(line.strip() for line in examples.strip().splitlines()[1:]), "```"]
    return page(lines)


def _options(parser: argparse.ArgumentParser, level: str) -> list[str]:
    """Tables of the arguments and of the options of a parser, without actions that have parsers of their own."""
    own = [action for action in parser._actions if not isinstance(action, argparse._SubParsersAction)]
    positional = [action for action in own if not action.option_strings]
    options = [action for action in own if action.option_strings]
    lines = []
    for title, actions in (("Arguments", positional), ("Options", options)):
        if actions:
            lines += [f"{level} {title}", "", *table(("name", "meaning"), [_row(action, parser) for action in actions])]
    return lines


def _prose(text: str) -> list[str]:
    """Paragraphs of a text for the terminal; what is indented there stays as it is."""
    lines = []
    for paragraph in text.strip("\n").split("\n\n"):
        shown = paragraph.startswith(" ")
        lines += ["```text", cleandoc(paragraph), "```", ""] if shown else [_with_options(paragraph), ""]
    return lines


def _with_options(text: str) -> str:
    """A sentence in which options are set as code."""
    return of_docstring(re.sub(r"(?<![\w`-])(--[a-z][a-z-]*)", r"`\1`", text))


def _row(action: argparse.Action, parser: argparse.ArgumentParser) -> tuple[str, str]:
    values = parser._get_formatter()._format_args(action, action.dest.upper()) if action.nargs != 0 else ""
    names = ", ".join(f"`{name}{f' {values}' if values else ''}`" for name in action.option_strings)
    help_text = (action.help or "") % {"default": action.default, "prog": parser.prog}
    return names or f"`{values}`", _with_options(help_text)
