"""The verdict on sets of effects, and what it rests on."""
