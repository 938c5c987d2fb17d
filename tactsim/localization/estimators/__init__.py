"""Estimators of a case file: one file each, found by its ``kind``."""
