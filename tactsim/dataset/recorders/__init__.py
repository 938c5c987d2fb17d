"""Recorders, one file for each kind of experiment."""
