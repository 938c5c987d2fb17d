"""How a sweep is computed: workers, what they compute, and going on where an earlier run stopped."""
