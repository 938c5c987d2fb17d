"""Figures of indentations."""
