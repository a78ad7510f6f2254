"""`maneuver library`: one file a verb."""
