"""Policies: nominal, worst case, adaptive gamma, price of robustness."""
