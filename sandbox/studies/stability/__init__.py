"""Scans over contact law and step that show when each method fails, how it fails, and if it warns."""
