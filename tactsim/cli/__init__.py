"""The command line; everything heavy is imported by the command that needs it."""

from tactsim.cli.entry import main

__all__ = ["main"]
