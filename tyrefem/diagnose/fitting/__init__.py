"""Sets of effects fitted to the data: steps, criterion, search, and what supports an effect."""
