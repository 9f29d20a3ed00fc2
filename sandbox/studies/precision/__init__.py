"""Work against precision: cases with known answers, our methods and other people's, and what each costs to be how wrong."""
