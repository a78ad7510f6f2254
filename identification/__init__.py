"""From flight logs to a motion-primitive library with uncertainties."""
