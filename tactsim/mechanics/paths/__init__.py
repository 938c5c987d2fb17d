"""The course of an experiment in load and in time."""
