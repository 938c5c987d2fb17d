"""One open page: what it may ask, what it has chosen, what is computed for it, and the messages that it gets."""
