"""The thesis's printed tables beside the computed ones."""
