"""Many missions flown and compared with their plans: grid, scorecards, pictures, trials."""
