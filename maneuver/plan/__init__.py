"""`maneuver plan`: one file a verb."""
