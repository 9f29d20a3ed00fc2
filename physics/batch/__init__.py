"""Batches of very many short chains: arrays with one row per chain, and kernels that simulate one row after the other."""
