"""Lumps found from readings of the jaws: localization, detectability, confusion."""
