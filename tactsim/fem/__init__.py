"""Finite elements: weak forms of a nearly or exactly incompressible body, compiled kernels, Newton, step control."""
