"""Memory and time of work, estimated before it begins.

Knows numbers of nodes, times and variants, and no tyre.
"""
