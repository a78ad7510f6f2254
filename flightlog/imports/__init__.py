"""Logs of other programs: PX4's ULog, MCAP, tables."""
