"""What a case can ask for: a folder for each family of kinds with all of it: fields, run, record, scene, figures, recorder."""
