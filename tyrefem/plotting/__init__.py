"""Pictures of a run, of a section, of a mesh and of a strain cycle. matplotlib is imported when one is drawn."""
