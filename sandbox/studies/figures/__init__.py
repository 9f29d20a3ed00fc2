"""The paper's figures and those of the data that it does not show: a module a topic, with its table and its drawing."""
