"""The forward model: values of unknowns to readings of the sensors, and sensitivities."""
