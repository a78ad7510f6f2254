"""Tests of the C kernel's branches, within 20 s."""
