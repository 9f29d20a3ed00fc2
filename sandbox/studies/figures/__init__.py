"""Figures of the paper, and of data that it mentions without showing: a module for each topic, with table and drawing."""
