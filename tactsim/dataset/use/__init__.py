"""What is made of a data set: its card, samples for training, files in the formats of others."""
