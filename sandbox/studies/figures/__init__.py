"""Figures of the paper, and figures of data that the paper mentions without showing.

Each topic has a module that computes a table and draws it.
"""
