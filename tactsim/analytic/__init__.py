"""Closed forms and exact numerical solutions: annular contact and linear viscoelasticity."""
