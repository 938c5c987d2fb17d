"""Meshes of quadratic elements: graded axisymmetric sections, refinement, quality."""
