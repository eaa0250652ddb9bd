"""Pages, pictures, tables and VTK files of every result.

Only this package and the command line write such files.
"""
