"""Reduced models: a rolling tyre's temperatures from a few dozen numbers instead of thousands."""
