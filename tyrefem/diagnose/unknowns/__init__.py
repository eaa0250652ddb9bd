"""What a diagnosis does not know: base numbers, sensors, effects, and what else may be wrong."""
