"""File names of the attachments of a flight log."""

LIBRARY_ATTACHMENT = "library.json"
"""The library flown with: names what `/primitive` counts, and carries the maneuver-end rule."""

INITIAL_STATE_ATTACHMENT = "initial_state.json"
"""The vehicle's true state at time 0; with controls and wind it reproduces the true motion."""

SPECIFICATION_ATTACHMENT = "specification.json"
"""All that the simulator needs to repeat the flight."""

FAULTS_ATTACHMENT = "faults.json"
"""What goes wrong in the flight, by numbers from 1: a JSON array of `flight.mission.fault.Fault`; absent in
most."""

PLANS_ATTACHMENT = "plans.json"
"""The plans of a flight in receding horizon, in order: a JSON array of `maneuver-plan/1` with their times."""

MISSION_ATTACHMENT = "mission.json"
"""The mission of a flight in receding horizon."""

ARRIVAL_ATTACHMENT = "arrival.json"
"""Whether a mission reached its goal: a `flight.mission.arrival.ArrivalVerdict`."""

VEHICLE_ATTACHMENT = "vehicle.json"
"""Every number of the vehicle that flew, with the changes that were made to it."""

IMPORT_ATTACHMENT = "import.json"
"""Where a log that another program wrote came from: its file, its SHA-256, what it says of itself."""

MODEL_ATTACHMENT = "model.xml"
"""The vehicle's shape, as MuJoCo's MJCF: x forward, y left, z up."""
