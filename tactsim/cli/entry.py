"""Finds the command, runs it, and turns every error into one message and an exit code."""

from __future__ import annotations

import argparse
import os
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from tactsim.cli import (
    command_compare,
    command_completion,
    command_data,
    command_list,
    command_material,
    command_new,
    command_run,
    command_schema,
    command_show,
    command_sweep,
    command_validate,
    console,
)
from tactsim.cli.interruption import interruptible
from tactsim.errors import INTERRUPTED, InputError, StorageError, TactsimError, suggestion
from tactsim.outside.defect_place import unless_own
from tactsim.outside.environment import check_environment
from tactsim.outside.extras import missing_extra
from tactsim.outside.library_warnings import collected_warnings
from tactsim.outside.text import one_line
from tactsim.version import __version__

COMMANDS = (
    command_run,
    command_new,
    command_list,
    command_show,
    command_compare,
    command_sweep,
    command_data,
    command_validate,
    command_material,
    command_schema,
    command_completion,
)
ONE_PLACE = {
    "tactsim show": "; several results are laid side by side by: tactsim compare",
    "tactsim data export": "; the place to write to follows --to",
}
"""What to do with a second place, of the commands that take one."""
EXIT_CODES = """\
exit codes:
  0    done
  1    a defect of tactsim; please report it
  2    bad input: the case file, an option or a quantity
  3    the computation did not converge, or a sample of a sweep failed; what was accepted is written
  4    a validation row without its recorded outcome, or findings of data check
  5    a file or folder cannot be read or written
  130  interrupted; what was accepted is written
"""


class _Parser(argparse.ArgumentParser):
    """An argument parser whose refusals are errors like all others, an empty path among them."""

    def __init__(self, **options: Any):
        super().__init__(**options)
        self.register("type", Path, _path)

    def error(self, message: str) -> NoReturn:
        """Refuses the arguments.

        Raises
        ------
        InputError
            Always.
        """
        raise InputError(f"{message}\nsee: {self.prog} --help")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuses what is none of the choices, and names a near one, as argparse itself can from Python 3.14 on."""
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            near = suggestion(str(value), map(str, action.choices or ()))
            raise argparse.ArgumentError(action, f"{error.message}{near}") from None


def _path(text: str) -> Path:
    """The path that an option or argument names; an empty one, which would be the working folder, is refused.

    Raises
    ------
    ArgumentTypeError
        If it is empty.
    """
    if not text.strip():
        raise argparse.ArgumentTypeError(f"{text!r} is no path; name a file or folder, . is the working folder")
    return Path(text)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code; ``arguments`` default to those of the process."""
    code = _exit_code(arguments)
    if lost := console.flush():
        console.error(f"cannot write all of the answer to standard output: {lost}; send it to another place")
        code = code or StorageError.exit_code
    return code


def _exit_code(arguments: Sequence[str] | None) -> int:
    """The exit code of a command line, every error reported."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy's threads and MKL's spin on the same cores
    debug = False
    try:
        check_environment(os.environ, Path())
        words = list(sys.argv[1:] if arguments is None else arguments)
        parser = _parser(next(iter(words), ""))
        parsed = _parsed(parser, words)
        if "run" not in parsed:
            console.out(parser.format_help())
            console.error("name one of the commands; tactsim COMMAND --help says more")
            return InputError.exit_code
        debug = parsed.debug
        with _printed_warnings(), interruptible():
            return int(parsed.run(parsed))
    except SystemExit as end:  # argparse ends --help and --version this way
        return int(end.code or 0)
    except KeyboardInterrupt as stop:
        # Until the next exec, an interrupt within one, as of a dataclass being made, lets Python end by SIGINT whatever the code.
        exec("")  # noqa: S102
        console.error(": ".join(("interrupted", *map(str, stop.args))))
        return INTERRUPTED
    except TactsimError as error:
        console.error(traceback.format_exc() if debug else str(error))
        return error.exit_code
    except ImportError as error:
        needed = missing_extra(error)
        if needed is None:
            return _defect(error, debug)
        console.error(traceback.format_exc() if debug else str(needed))
        return needed.exit_code
    except MemoryError:
        console.error(traceback.format_exc() if debug else "not enough memory; take a smaller problem or a larger machine")
        return StorageError.exit_code
    except OSError as error:
        what = f" {one_line(error.filename)}" if error.filename else ""
        message = f"the system refused{what}: {error.strerror or one_line(error)}"
        console.error(traceback.format_exc() if debug else message)
        return StorageError.exit_code
    except Exception as error:  # noqa: BLE001  the last resort: a defect of tactsim is reported as such
        return _defect(error, debug)


def _parsed(parser: argparse.ArgumentParser, words: Sequence[str]) -> argparse.Namespace:
    """The arguments of a command line.

    Raises
    ------
    InputError
        If one is unknown, with the help of the command that does not know it.
    """
    parsed, unknown = parser.parse_known_args(words)
    if unknown:
        named = [words[0]] if words[0] in [command.NAME for command in COMMANDS] else []
        command = " ".join(["tactsim", *named, *([parsed.action] if "action" in parsed else [])])
        advice = "" if any(word.startswith("-") for word in unknown) else ONE_PLACE.get(command, "")
        raise InputError(f"unrecognized arguments: {one_line(' '.join(unknown))}{advice}\nsee: {command} --help")
    return parsed


def _defect(error: Exception, debug: bool) -> int:
    """Report an error that tactsim does not raise on purpose; the exit code."""
    trace = traceback.format_exc() if debug else "run again with --debug for the details"
    console.error(f"internal error ({type(error).__name__}: {one_line(error)}); please report it{unless_own(error)}; {trace}")
    return TactsimError.exit_code


@contextmanager
def _printed_warnings() -> Iterator[None]:
    """A block whose warnings of libraries are printed when it ends, those that no result holds."""
    with collected_warnings() as collected:
        try:
            yield
        finally:
            for line in collected.lines():
                console.note(f"warning: {line}")


def _parser(first: str = "") -> argparse.ArgumentParser:
    """The parser of all commands; if the ``first`` word names one, of the arguments of this one only, in half the time."""
    only = first if first in [command.NAME for command in COMMANDS] else None
    parser = _Parser(
        prog="tactsim",
        description="Physics simulation of tactile sensing on soft tissue.",
        epilog=f"example:\n  tactsim run annulus_icf\n\n{EXIT_CODES}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"tactsim {__version__}")
    parser.set_defaults(debug=False)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for command in COMMANDS:
        sub = commands.add_parser(
            command.NAME,
            help=command.SUMMARY,
            description=command.DESCRIPTION,
            epilog=f"{command.EXAMPLES}\n{EXIT_CODES}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if only in (None, command.NAME):
            command.add_arguments(sub)
        sub.add_argument("--debug", action="store_true", help="show the traceback of an error")
        sub.set_defaults(run=command.run, parser=_parser)
    return parser
