"""tactsim: physics simulation of tactile sensing on soft tissue."""

__version__ = "0.1.0"
