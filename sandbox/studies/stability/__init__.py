"""Scans over contact law and step: for which of them each method fails, how, and with or without a warning."""
