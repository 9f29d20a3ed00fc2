"""Where each method breaks: maps over the contact law and the step, and sentences on what fails, how, and from where."""
