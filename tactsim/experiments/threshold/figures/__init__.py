"""Figures of threshold sensors."""
