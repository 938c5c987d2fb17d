"""Films whose resistance or capacitance follows the force on them."""
