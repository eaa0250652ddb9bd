"""The law of missing heat over the runs."""
