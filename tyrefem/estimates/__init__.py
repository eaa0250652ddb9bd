"""Memory and time of work, estimated before its start.

The inputs are numbers of nodes, times and variants; the package is independent of tyres.
"""
