"""What a sensor makes of the contact: matrices of taxels on the jaws."""
