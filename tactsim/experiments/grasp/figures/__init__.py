"""Figures of grasps."""
