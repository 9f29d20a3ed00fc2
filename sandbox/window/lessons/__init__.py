"""Lessons: questions about a scene whose answers the user predicts before they are measured."""
