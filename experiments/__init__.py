"""Campaigns and closed-loop flights: execution, evaluation, comparison."""
