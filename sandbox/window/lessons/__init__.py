"""Lessons: a question about a scene to predict, and the answer measured."""
