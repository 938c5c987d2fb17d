"""The version of tactsim."""

__version__ = "0.1.0"
