"""Review of flight logs: summaries, pages, pictures and films."""
