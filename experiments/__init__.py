"""Closed loops and campaigns: flown, judged and compared. The stages meet here."""
