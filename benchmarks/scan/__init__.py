"""The scan solves random chains of several families. Each chain is solved with a tested method and with an independent
reference.
"""
