"""Sets of effects beside what else may be wrong with the model."""
