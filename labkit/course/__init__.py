"""The learner's folder, and running, recording and testing the lessons."""
