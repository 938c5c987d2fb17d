"""Threshold sensors on tissue: trials with scatter, and the tip of a catheter."""
