"""A rigid body pressed into tissue: axisymmetric or 3D, along a load path or in time."""
