"""Lumps located from readings of the jaws: localization, detectability, confusion."""
