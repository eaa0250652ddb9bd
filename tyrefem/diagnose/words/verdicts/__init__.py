"""Every verdict in words: a module has its three first sentences and its paragraph."""
