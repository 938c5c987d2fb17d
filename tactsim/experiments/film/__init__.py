"""Tests of a sensor film and its electronics: response, creep, calibration."""
