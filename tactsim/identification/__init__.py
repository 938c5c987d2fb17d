"""Constants from measurements: stress-strain and relaxation curves, dynamic mechanical analysis, films, calibration lines."""
