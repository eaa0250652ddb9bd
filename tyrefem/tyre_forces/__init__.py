"""Forces of a rolling tyre over slip, angle and camber: points, the Magic Formula, `.tir` files.

It does not know where the points come from: no section, no study, no mechanics.
"""
