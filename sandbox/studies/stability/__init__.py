"""Scans of failure: over contact law and step, where each method fails, how, and with or without a warning."""
