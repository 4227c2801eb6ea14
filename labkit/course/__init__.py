"""The course as a whole: the learner's folder, and running, recording and testing the lessons."""
