"""What people read: pages, pictures, tables and VTK files of every result.

The only room beside the command line that writes such files.
"""
