"""Tissue with inclusions grasped between two jaws that carry matrices of force sensors."""
