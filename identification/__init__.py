"""Identification of motion-primitive libraries with errors from flight logs."""
