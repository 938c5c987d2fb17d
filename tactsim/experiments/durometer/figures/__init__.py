"""Figures of hardness tests."""
