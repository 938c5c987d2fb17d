"""What a case can ask for: a folder for each family of kinds with all that belongs to it: fields, run, figures, recorder."""
