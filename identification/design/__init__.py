"""Design of campaigns: schedules of flights, kinematic libraries, trend automata."""
