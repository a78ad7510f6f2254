"""The words that every stage shares; imports nothing of ours, no simulator and no solver."""
