"""Hardness after ASTM D2240: the test simulated, and elastomers ranked by it."""
