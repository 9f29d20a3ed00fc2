"""The scan solves random chains of several families. Each is solved by a tested method and by an independent reference."""
