"""Long trials beside the tests: random cases that a user could write, and damage to all that is read and written."""
