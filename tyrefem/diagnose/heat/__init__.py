"""Heat of unknown origin: places, courses in time, evidence."""
