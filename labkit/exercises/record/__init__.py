"""What is kept of a learner: progress, the class sheet, and who takes part."""
