"""What sensors and runs can tell before a test: isolability, calibration."""
