"""Errors that move on their own: at corners, between them, and at most (thesis, appendix B)."""
