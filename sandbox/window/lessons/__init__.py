"""Lessons: questions about a scene. The user predicts the answer before the scene is played."""
