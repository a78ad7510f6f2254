"""Checks of plans and certificates; imports no other room, so its walks and flows of trims are copies."""
