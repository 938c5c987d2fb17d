"""Files and folders that tactsim writes: whole or absent, one process at a time, never in place of what somebody else wrote."""
