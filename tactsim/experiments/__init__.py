"""What a case can ask for: one folder for each family of kinds, with its fields, run, record, figures and recorder."""
