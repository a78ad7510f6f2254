"""Identity of flights, fingerprints of logs, and differences of logs."""
