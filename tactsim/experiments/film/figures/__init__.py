"""Figures of tests of films."""
