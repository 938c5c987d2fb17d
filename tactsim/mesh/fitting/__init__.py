"""From labelled tetrahedra with straight sides to curved ones that fit the surfaces of a block and its inclusions."""
