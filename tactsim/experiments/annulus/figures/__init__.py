"""Figures of closed forms of the annulus."""
