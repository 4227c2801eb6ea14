"""Make a machine ready for the course, in bare Python from 3.8 on."""
