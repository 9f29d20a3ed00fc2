"""Bed friction and contact loss for adaptive methods: pieces of motion in which nothing changes between stick and slip."""
