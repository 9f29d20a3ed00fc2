"""Measurements that test the statements of the paper. Each statement has one function, and its numbers give a verdict."""
