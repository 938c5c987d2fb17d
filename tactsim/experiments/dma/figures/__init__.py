"""Figures of a dynamic mechanical analysis: curves with bands, and signals with moduli."""
