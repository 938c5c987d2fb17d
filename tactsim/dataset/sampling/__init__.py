"""What a sweep draws: distributions, designs, the cases of its samples, and the variables that it stores of them."""
