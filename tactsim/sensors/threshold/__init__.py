"""Threshold sensors: an annulus around an inner sensor, alone or in a ring around a catheter's tip."""
