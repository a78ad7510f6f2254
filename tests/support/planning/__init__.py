"""Libraries, missions and plans that tests of the planner share."""
