"""File names of the attachments of a flight log."""

LIBRARY_ATTACHMENT = "library.json"
"""The library flown with: ids of `/primitive`, and the maneuver-end rule."""

INITIAL_STATE_ATTACHMENT = "initial_state.json"
"""The vehicle's true state at time 0; with controls and wind it reproduces the true motion."""

SPECIFICATION_ATTACHMENT = "specification.json"
"""Input of the simulator that repeats the flight."""

FAULTS_ATTACHMENT = "faults.json"
"""Injected faults, numbered from 1: a JSON array of `flight.mission.fault.Fault`; absent without faults."""

PLANS_ATTACHMENT = "plans.json"
"""The plans of a flight in receding horizon, in order: a JSON array of `maneuver-plan/1` with their times."""

MISSION_PLAN_ATTACHMENT = "mission_plan.json"
"""The plan for the mission as stated, as `maneuver plan` makes it: a `maneuver-plan/2`."""

POLICY_ATTACHMENT = "policy.json"
"""Statement of the policy with feedback about the mission, with its table's name: a `maneuver-policy/1`."""

MISSION_ATTACHMENT = "mission.json"
"""The mission of a flight in receding horizon."""

ARRIVAL_ATTACHMENT = "arrival.json"
"""Arrival verdict of a mission: a `flight.mission.arrival.ArrivalVerdict`."""

VEHICLE_ATTACHMENT = "vehicle.json"
"""All parameters of the vehicle believed; what flew differs by the header's `drawn`."""

IMPORT_ATTACHMENT = "import.json"
"""Origin of an imported log: file name, SHA-256 and the log's own information."""

MODEL_ATTACHMENT = "model.xml"
"""The vehicle's shape, as MuJoCo's MJCF: x forward, y left, z up."""
