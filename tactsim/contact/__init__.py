"""Rigid bodies as signed distances, friction laws, and the contact traction at a point."""
