"""Rigid bodies against tissue: contact at a pose, equilibrium, what every such state is held to, forces on patches."""
