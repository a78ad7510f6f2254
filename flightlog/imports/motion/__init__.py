"""Evidence that a measured motion gives of its units, axes and breaks."""
