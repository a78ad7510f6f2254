"""Identity of a flight, fingerprint of a log, and differences of two logs."""
