"""Pictures of flights, libraries, plans and trends."""
