"""Independent errors: corners, boxes and bounds (thesis, appendix B)."""
