"""Policies: nominal, worst case, adaptive gamma, price of robustness.

The committed policy has a room of its own, `planner/commitment`.
"""
