"""A tyre of few bodies, each of one temperature: its films and heat capacities from plateaus and time constants.

Real-time tyre models take such numbers. The room knows cards and units; it knows no section, study or run.
"""
